// Floor 2: robots, walls, doors and objects.
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/world/world.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace robotteamsim::bindings {
namespace {

DriveKind ToKind(const std::string& name) {
  if (name == "differential") return DriveKind::kDifferential;
  if (name == "omni") return DriveKind::kOmni;
  if (name == "car") return DriveKind::kCar;
  throw std::invalid_argument("a drive must be differential, omni or car, got " + name);
}

const char* NameOf(LeafActivity activity) {
  switch (activity) {
    case LeafActivity::kOpens:
      return "opens";
    case LeafActivity::kCloses:
      return "closes";
    case LeafActivity::kHeld:
      return "held";
    case LeafActivity::kStill:
      break;
  }
  return "still";
}

int CheckedObject(const World& world, int object) {
  if (object < 0 || object >= static_cast<int>(world.things().size())) throw std::out_of_range("no such object");
  return object;
}

// The angles of contact of those robots that touch something, by their ids.
std::map<int, std::vector<double>> ContactAngles(const World& world) {
  std::map<int, std::vector<double>> angles;
  for (int i = 0; i < static_cast<int>(world.in_contact().size()); ++i) {
    if (world.in_contact()[i]) angles[i] = world.contact_angles(i);
  }
  return angles;
}

void StepByRows(World& world, const Triples& twists) {
  const auto* const rows = reinterpret_cast<const Twist*>(twists.data());
  world.Step({rows, rows + twists.shape(0)});
}

void BindParts(nb::module_& m) {
  nb::class_<Solid>(m, "Solid")
      .def(
          "__init__",
          [](Solid* self, const Polygon& outline_m, const std::vector<Polygon>& pieces_m) {
            new (self) Solid{outline_m, pieces_m};
          },
          "outline_m"_a, "pieces_m"_a);
  nb::class_<Door>(m, "Door").def(
      "__init__",
      [](Door* self, const Solid& leaf, bool closed, double time_s, double angle_rad, const Point& shift_m,
         const Point& hinge_m) {
        new (self) Door{leaf, closed, {time_s, angle_rad, shift_m, hinge_m}};
      },
      "leaf"_a, "closed"_a, nb::kw_only(), "time_s"_a = 0.0, "angle_rad"_a = 0.0, "shift_m"_a = Point(),
      "hinge_m"_a = Point());
  nb::class_<DoorState>(m, "DoorState")
      .def_ro("closed", &DoorState::closed)
      .def_ro("opening", &DoorState::opening)
      .def_prop_ro(
          "motion", [](const DoorState& state) { return NameOf(state.activity); },
          nb::for_getter(nb::sig("def motion(self) -> typing.Literal['still', 'opens', 'closes', 'held']")));
  nb::class_<DriveLimits>(m, "Drive")
      .def(
          "__init__",
          [](DriveLimits* self, const std::string& kind, double max_speed, double max_acceleration, double max_turn,
             double max_turn_acceleration, double wheelbase, double max_steering, double max_steering_rate) {
            new (self) DriveLimits{max_speed,    max_turn,  max_acceleration, max_turn_acceleration,
                                   ToKind(kind), wheelbase, max_steering,     max_steering_rate};
          },
          nb::kw_only(), "kind"_a, "max_speed_mps"_a, "max_acceleration_mps2"_a, "max_turn_radps"_a = 0.0,
          "max_turn_acceleration_radps2"_a = 0.0, "wheelbase_m"_a = 0.0, "max_steering_rad"_a = 0.0,
          "max_steering_rate_radps"_a = 0.0);
  nb::class_<Robot>(m, "Robot")
      .def(
          "__init__",
          [](Robot* self, double radius_m, double mass_kg, const DriveLimits& drive, const Pose& start,
             const Polygon& footprint_m,
             bool present) { new (self) Robot{radius_m, mass_kg, drive, start, footprint_m, present}; },
          nb::kw_only(), "radius_m"_a, "mass_kg"_a, "drive"_a, "start"_a, "footprint_m"_a = Polygon(),
          "present"_a = true);
  nb::class_<Thing>(m, "MovableObject")
      .def(
          "__init__",
          [](Thing* self, double radius_m, double mass_kg, double friction, const Pose& start,
             const Polygon& corners_m) {
            new (self) Thing{radius_m, mass_kg, friction, start, corners_m};
          },
          nb::kw_only(), "radius_m"_a, "mass_kg"_a, "friction"_a, "start"_a, "corners_m"_a);
}

}  // namespace

void BindWorld(nb::module_& m) {
  BindParts(m);
  nb::class_<World>(m, "World")
      .def(nb::init<std::vector<Solid>, std::vector<Door>, std::vector<Robot>, double, int, std::vector<Thing>>(),
           "solids"_a, "doors"_a, "robots"_a, "step_s"_a, "substeps"_a, "objects"_a = std::vector<Thing>())
      .def("step", &StepByRows, "twists"_a)
      .def("step", &World::Step, "twists"_a)
      .def("object_poses", [](const World& world) { return RowsOf<3>(world.thing_poses()); })
      .def("poses", [](const World& world) { return RowsOf<3>(world.poses()); })
      .def("twists", [](const World& world) { return RowsOf<3>(world.twists()); })
      .def("motions", [](const World& world) { return RowsOf<3>(world.motions()); })
      .def("in_contact", [](const World& world) { return FlagsOf(world.in_contact()); })
      .def("contact_angles", &ContactAngles)
      .def("set_pose", &World::SetPose, "robot_id"_a, "pose"_a)
      .def("remove_robot", &World::RemoveRobot, "robot_id"_a)
      .def("spawn_robot", &World::SpawnRobot, "robot_id"_a, "pose"_a)
      .def("present", [](const World& world) { return FlagsOf(world.present()); })
      .def("arrivals", &World::arrivals)
      .def("set_door", &World::SetDoorClosed, "door"_a, "closed"_a)
      .def_prop_ro("doors_version", &World::doors_version)
      .def("door_states", &World::door_states)
      .def("add_object", &World::AddThing, "added"_a)
      .def(
          "remove_object", [](World& world, int object) { world.RemoveThing(CheckedObject(world, object)); }, "index"_a)
      .def(
          "set_object_pose",
          [](World& world, int object, const Pose& pose) { world.SetThingPose(CheckedObject(world, object), pose); },
          "index"_a, "pose"_a)
      .def("reset", &World::Reset);
}

}  // namespace robotteamsim::bindings
