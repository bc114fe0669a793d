// _core.simulation: totals over a trial.
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/simulation/team_totals.hpp"

namespace robotteamsim::bindings {
namespace {

void AddStep(simulation::TeamTotals& totals, const Points& positions_m, const Array<const bool, -1>& in_contact,
             const std::vector<bool>& excluded, bool running) {
  totals.AddStep(RecordsOf<base::Point>(positions_m), ValuesOf<bool>(in_contact), excluded, running);
}

}  // namespace

void BindSimulation(nb::module_&& m) {
  nb::class_<simulation::RobotTotals>(m, "RobotTotals")
      .def_ro("distance_m", &simulation::RobotTotals::distance_m)
      .def_ro("contact_steps", &simulation::RobotTotals::contact_steps)
      .def_ro("excluded_steps", &simulation::RobotTotals::excluded_steps)
      .def_ro("longest_stay_steps", &simulation::RobotTotals::longest_stay);
  nb::class_<simulation::TeamTotals>(m, "TeamTotals")
      .def(nb::init<int>(), "num_robots"_a)
      .def("add_step", &AddStep, "positions_m"_a, "in_contact"_a, "excluded"_a, "running"_a)
      .def("totals", &simulation::TeamTotals::Totals);
}

}  // namespace robotteamsim::bindings
