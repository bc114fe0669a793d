// Floor 2: what is true of robots, walls and doors.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "robotteamsim/world/world.hpp"
#include "world_arrays.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using Corners = std::vector<std::pair<double, double>>;
using Triple = std::array<double, 3>;

Polygon ToPolygon(const Corners& corners) {
  Polygon polygon;
  for (const auto& [x, y] : corners) polygon.push_back({x, y});
  return polygon;
}

Solid ToSolid(const Corners& outline, const std::vector<Corners>& pieces) {
  Solid solid{ToPolygon(outline), {}};
  for (const Corners& piece : pieces) solid.pieces.push_back(ToPolygon(piece));
  return solid;
}

Robot ToRobot(double radius_m, double mass_kg, const DriveLimits& drive, const Triple& start,
              const Corners& footprint_m, bool present) {
  return {radius_m, mass_kg, drive, {start[0], start[1], start[2]}, ToPolygon(footprint_m), present};
}

Thing ToThing(double radius_m, double mass_kg, double friction, const Triple& start, const Corners& corners_m) {
  return {radius_m, mass_kg, friction, {start[0], start[1], start[2]}, ToPolygon(corners_m)};
}

using Pair = std::pair<double, double>;

Door ToDoor(const Solid& leaf, bool closed, double time_s, double angle_rad, const Pair& shift_m, const Pair& hinge_m) {
  return {leaf, closed, {time_s, angle_rad, {shift_m.first, shift_m.second}, {hinge_m.first, hinge_m.second}}};
}

// By the indices of doors that swing or slide: opening, whether it shall close, whether it is held.
py::dict Leaves(const World& world) {
  py::dict leaves;
  for (const MovingLeaf& leaf : world.leaves()) {
    leaves[py::int_(leaf.door)] = py::make_tuple(leaf.opening, leaf.shall_close, leaf.is_held);
  }
  return leaves;
}

int CheckedThing(const World& world, int thing) {
  if (thing < 0 || thing >= static_cast<int>(world.things().size())) throw py::index_error("there is no such thing");
  return thing;
}

DriveKind ToKind(const std::string& name) {
  if (name == "differential") return DriveKind::kDifferential;
  if (name == "omni") return DriveKind::kOmni;
  if (name == "car") return DriveKind::kCar;
  throw std::invalid_argument("a drive is differential, omni or car, not " + name);
}

DriveLimits ToDrive(const std::string& kind, double max_speed, double max_acceleration, double max_turn,
                    double max_turn_acceleration, double wheelbase, double max_steering, double max_steering_rate) {
  return {max_speed,    max_turn,  max_acceleration, max_turn_acceleration,
          ToKind(kind), wheelbase, max_steering,     max_steering_rate};
}

std::vector<Twist> RowsOf(const Doubles& twists) {
  if (twists.ndim() != 2 || twists.shape(1) != 3) throw std::invalid_argument("twists must be three numbers per robot");
  std::vector<Twist> commands(static_cast<std::size_t>(twists.shape(0)));
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const double* const row = twists.data() + 3 * i;
    commands[i] = {row[0], row[1], row[2]};
  }
  return commands;
}

double NumberAt(PyObject* tuple, py::ssize_t index) {
  const double number = PyFloat_AsDouble(PyTuple_GET_ITEM(tuple, index));
  if (number == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
  return number;
}

std::vector<Twist> TuplesOf(const py::object& twists) {
  const auto items = py::reinterpret_steal<py::object>(PySequence_Fast(twists.ptr(), "twists must be a sequence"));
  if (!items) throw py::error_already_set();
  std::vector<Twist> commands;
  commands.reserve(static_cast<std::size_t>(PySequence_Fast_GET_SIZE(items.ptr())));
  for (py::ssize_t i = 0; i < PySequence_Fast_GET_SIZE(items.ptr()); ++i) {
    PyObject* const twist = PySequence_Fast_GET_ITEM(items.ptr(), i);
    if (!PyTuple_Check(twist) || PyTuple_GET_SIZE(twist) != 3) {
      throw std::invalid_argument("a twist must be a tuple of three numbers");
    }
    commands.push_back({NumberAt(twist, 0), NumberAt(twist, 1), NumberAt(twist, 2)});
  }
  return commands;
}

// A twist per robot: each a tuple of three, for few robots faster than an array, or a row of an array.
void Step(World& world, const py::object& twists) {
  world.Step(py::isinstance<py::array>(twists) ? RowsOf(twists.cast<Doubles>()) : TuplesOf(twists));
}

}  // namespace

void BindWorld(py::module_& m) {
  py::class_<Solid>(m, "Solid").def(py::init(&ToSolid), py::arg("outline_m"), py::arg("pieces_m"));
  py::class_<Door>(m, "Door").def(py::init(&ToDoor), py::arg("leaf"), py::arg("closed"), py::kw_only(),
                                  py::arg("time_s") = 0.0, py::arg("angle_rad") = 0.0, py::arg("shift_m") = Pair(),
                                  py::arg("hinge_m") = Pair());
  py::class_<DriveLimits>(m, "Drive")
      .def(py::init(&ToDrive), py::kw_only(), py::arg("kind"), py::arg("max_speed_mps"),
           py::arg("max_acceleration_mps2"), py::arg("max_turn_radps") = 0.0,
           py::arg("max_turn_acceleration_radps2") = 0.0, py::arg("wheelbase_m") = 0.0,
           py::arg("max_steering_rad") = 0.0, py::arg("max_steering_rate_radps") = 0.0);
  py::class_<Robot>(m, "Robot")
      .def(py::init(&ToRobot), py::arg("radius_m"), py::arg("mass_kg"), py::arg("drive"), py::arg("start"),
           py::arg("footprint_m") = Corners(), py::arg("present") = true);
  py::class_<Thing>(m, "Thing")
      .def(py::init(&ToThing), py::kw_only(), py::arg("radius_m"), py::arg("mass_kg"), py::arg("friction"),
           py::arg("start"), py::arg("corners_m"));
  py::class_<World> world(m, "World");
  world
      .def(py::init<std::vector<Solid>, std::vector<Door>, std::vector<Robot>, double, int, std::vector<Thing>>(),
           py::arg("solids"), py::arg("doors"), py::arg("robots"), py::arg("step_s"), py::arg("substeps"),
           py::arg("things") = std::vector<Thing>())
      .def("thing_poses", [](const World& world) { return ToArray(world.thing_poses()); })
      .def("poses", [](const World& world) { return ToArray(world.poses()); })
      .def("pose_readings", &PoseReadings)
      .def("twists", [](const World& world) { return ToArray(world.twists()); })
      .def("motions", [](const World& world) { return ToArray(world.motions()); })
      .def("in_contact", [](const World& world) { return ToFlags(world.in_contact()); })
      .def("contact_angles", &ContactAngles)
      .def(
          "set_pose",
          [](World& world, int robot_id, const Triple& pose) {
            world.SetPose(robot_id, {pose[0], pose[1], pose[2]});
          },
          py::arg("robot_id"), py::arg("pose"))
      .def("remove_robot", &World::RemoveRobot, py::arg("robot_id"))
      .def(
          "spawn_robot",
          [](World& world, int robot_id, const Triple& pose) {
            world.SpawnRobot(robot_id, {pose[0], pose[1], pose[2]});
          },
          py::arg("robot_id"), py::arg("pose"))
      .def("present", [](const World& world) { return ToFlags(world.present()); })
      .def("arrivals", &World::arrivals)
      .def("set_door", &World::SetDoorClosed, py::arg("door"), py::arg("closed"))
      .def("door_closed", [](const World& world, int door) { return world.doors().at(door).closed; })
      .def("leaves", &Leaves)
      .def("add_thing", &World::AddThing, py::arg("thing"))
      .def(
          "remove_thing", [](World& world, int thing) { world.RemoveThing(CheckedThing(world, thing)); },
          py::arg("thing"))
      .def(
          "set_thing_pose",
          [](World& world, int thing, const Triple& pose) {
            world.SetThingPose(CheckedThing(world, thing), {pose[0], pose[1], pose[2]});
          },
          py::arg("thing"), py::arg("pose"))
      .def("reset", &World::Reset);
  DefFast<&Step>(world, "step");
}

}  // namespace robotteamsim::bindings
