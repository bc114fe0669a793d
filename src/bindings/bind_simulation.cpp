// Floor 7: what is added up over a trial.
#include <pybind11/numpy.h>

#include <stdexcept>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "robotteamsim/simulation/team_figures.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

// Steps one by one: positions of shape (steps, robots, 2), flags of (steps, robots), running of (steps,).
void AddSteps(TeamFigures& figures, const Doubles& positions_m, const Flags& in_contact, const Flags& excluded,
              const Flags& running) {
  const py::ssize_t steps = running.size(), robots = figures.num_robots();
  if (positions_m.size() != 2 * steps * robots || in_contact.size() != steps * robots ||
      excluded.size() != steps * robots) {
    throw std::invalid_argument("positions and flags must have one row per robot in each step");
  }
  const double* position = positions_m.data();
  const bool *contact = in_contact.data(), *is_excluded = excluded.data();
  for (py::ssize_t step = 0; step < steps; ++step) {
    for (int robot = 0; robot < robots; ++robot, position += 2) {
      figures.Add(robot, {position[0], position[1]}, *contact++, *is_excluded++, running.data()[step]);
    }
  }
}

// Of each robot: distance [m], steps in contact, steps excluded, longest stay [steps].
py::list Sums(const TeamFigures& figures) {
  py::list sums;
  for (int robot = 0; robot < figures.num_robots(); ++robot) {
    const RobotFigures& of = figures.of(robot);
    sums.append(py::make_tuple(of.distance, of.contact_steps, of.excluded_steps, of.longest_stay));
  }
  return sums;
}

}  // namespace

void BindSimulation(py::module_& m) {
  py::class_<TeamFigures> figures(m, "TeamFigures");
  figures.def(py::init<int>(), py::arg("num_robots")).def("sums", &Sums);
  DefFast<&AddSteps>(figures, "add_steps");
}

}  // namespace robotteamsim::bindings
