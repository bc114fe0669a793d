// The private module robotteamsim._core: one submodule per floor of the C++ library.
#include "bindings.hpp"

namespace {

struct Floor {
  const char *name, *doc;
  void (*bind)(nanobind::module_&);
};

// In the order of floors: a submodule uses the classes of those before it.
constexpr Floor kFloors[] = {
    {"base", "Lengths and nearest points.", &robotteamsim::bindings::BindBase},
    {"plan", "Path planning on a known map.", &robotteamsim::bindings::BindPlan},
    {"world", "Robots, walls, doors and objects.", &robotteamsim::bindings::BindWorld},
    {"propagation", "Fading of radio and voice.", &robotteamsim::bindings::BindPropagation},
    {"hazards", "Fire, smoke and heat.", &robotteamsim::bindings::BindHazards},
    {"sensing", "Lasers, odometry and hearing.", &robotteamsim::bindings::BindSensing},
    {"network", "Links between robots.", &robotteamsim::bindings::BindNetwork},
    {"swarm", "Velocities of a robotic swarm.", &robotteamsim::bindings::BindSwarm},
    {"control", "Driving, and the memory of a robot.", &robotteamsim::bindings::BindControl},
    {"simulation", "Totals over a trial.", &robotteamsim::bindings::BindSimulation},
};

}  // namespace

NB_MODULE(_core, m) {
  // Caches of floor plans and messages live until the process ends; Python does not clear them then.
  nanobind::set_leak_warnings(false);
  m.doc() = "C++ core of robotteamsim; use the typed Python packages instead.";
  for (const Floor& floor : kFloors) {
    nanobind::module_ submodule = m.def_submodule(floor.name, floor.doc);
    floor.bind(submodule);
  }
}
