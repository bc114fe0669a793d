// _core.simulation: totals over a trial.
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/simulation/team_totals.hpp"

namespace robotteamsim::bindings {
namespace {

using FlagRows = Array<const bool, -1, -1>;

void AddSteps(simulation::TeamTotals& totals, const Array<const double, -1, -1, 2>& positions_m,
              const FlagRows& in_contact, const FlagRows& excluded, const Array<const bool, -1>& running) {
  const auto* const positions = reinterpret_cast<const base::Point*>(positions_m.data());
  totals.AddSteps({positions, positions_m.shape(0), positions_m.shape(1)}, TableOf(in_contact), TableOf(excluded),
                  ValuesOf<bool>(running));
}

}  // namespace

void BindSimulation(nb::module_&& m) {
  nb::class_<simulation::RobotTotals>(m, "RobotTotals")
      .def_ro("distance_m", &simulation::RobotTotals::distance)
      .def_ro("contact_steps", &simulation::RobotTotals::contact_steps)
      .def_ro("excluded_steps", &simulation::RobotTotals::excluded_steps)
      .def_ro("longest_stay_steps", &simulation::RobotTotals::longest_stay);
  nb::class_<simulation::TeamTotals>(m, "TeamTotals")
      .def(nb::init<int>(), "num_robots"_a)
      .def("add_steps", &AddSteps, "positions_m"_a, "in_contact"_a, "excluded"_a, "running"_a)
      .def("totals", &simulation::TeamTotals::Totals);
}

}  // namespace robotteamsim::bindings
