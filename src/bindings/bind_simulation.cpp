// _core.simulation: totals over a trial.
#include <vector>

#include "bindings.hpp"
#include "casters.hpp"
#include "mission_state.hpp"
#include "robotteamsim/simulation/team_totals.hpp"

namespace robotteamsim::bindings {
namespace {

void AddStep(simulation::TeamTotals& totals, const MissionState& view, const std::vector<bool>& excluded,
             bool running) {
  const state::State& state = view.state();
  const auto first = static_cast<std::ptrdiff_t>(state.First(view.mission()));
  const auto end = first + static_cast<std::ptrdiff_t>(state.robots);
  totals.AddStep({state.positions.begin() + first, state.positions.begin() + end},
                 {state.contact.begin() + first, state.contact.begin() + end}, excluded, running);
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
      .def("add_step", &AddStep, "state"_a, "excluded"_a, "running"_a)
      .def("totals", &simulation::TeamTotals::Totals);
}

}  // namespace robotteamsim::bindings
