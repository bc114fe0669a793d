// _core.simulation: totals over a trial.
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/simulation/team_totals.hpp"

namespace robotteamsim::bindings {
namespace {

using FlagRows = Array<const bool, -1, -1>;

void AddSteps(simulation::TeamTotals& totals, const Array<const double, -1, -1, 2>& positions_m,
              const FlagRows& in_contact, const FlagRows& excluded, const Array<const bool, -1>& running) {
  const std::size_t steps = running.size(), robots = static_cast<std::size_t>(totals.num_robots());
  if (positions_m.size() != 2 * steps * robots || in_contact.size() != steps * robots ||
      excluded.size() != steps * robots) {
    throw std::invalid_argument("positions and flags must have one row per robot in each step");
  }
  const auto* position = reinterpret_cast<const base::Point*>(positions_m.data());
  const bool *contact = in_contact.data(), *is_excluded = excluded.data();
  for (std::size_t step = 0; step < steps; ++step) {
    for (int robot = 0; robot < totals.num_robots(); ++robot) {
      totals.Add(robot, *position++, *contact++, *is_excluded++, running.data()[step]);
    }
  }
}

std::vector<simulation::RobotTotals> Totals(const simulation::TeamTotals& totals) {
  std::vector<simulation::RobotTotals> of_robots;
  of_robots.reserve(static_cast<std::size_t>(totals.num_robots()));
  for (int robot = 0; robot < totals.num_robots(); ++robot) of_robots.push_back(totals.of(robot));
  return of_robots;
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
      .def("totals", &Totals);
}

}  // namespace robotteamsim::bindings
