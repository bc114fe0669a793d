// The private module robotteamsim._core: one submodule per floor of the C++ library.
#include "bindings.hpp"

NB_MODULE(_core, m) {
  using namespace robotteamsim::bindings;
  // Caches of floor plans and messages live until the process ends; Python does not clear them then.
  nanobind::set_leak_warnings(false);
  m.doc() = "C++ core of robotteamsim; use the typed Python packages instead.";
  // In the order of floors: a submodule uses the classes of those before it.
  BindBase(m.def_submodule("base", "Lengths and nearest points."));
  BindPlan(m.def_submodule("plan", "Path planning on a known map."));
  BindWorld(m.def_submodule("world", "Robots, walls, doors and objects."));
  BindPropagation(m.def_submodule("propagation", "Fading of radio and voice."));
  BindHazards(m.def_submodule("hazards", "Fire, smoke and heat."));
  BindState(m.def_submodule("state", "The numbers of missions after a step."));
  BindSensing(m.def_submodule("sensing", "Lasers, odometry and hearing."));
  BindNetwork(m.def_submodule("network", "Links between robots."));
  BindSwarm(m.def_submodule("swarm", "Velocities of a robotic swarm."));
  BindMaps(m.def_submodule("maps", "What a robot knows of the building, and where it is."));
  BindControl(m.def_submodule("control", "Driving, and the memory of a robot."));
  BindSimulation(m.def_submodule("simulation", "Steps of many missions, and totals over a trial."));
  BindLearning(m.def_submodule("learning", "What agents perceive."));
  BindRecording(m.def_submodule("recording", "Messages of ROS as bytes."));
}
