// _core.world: robots, walls, doors and objects.
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/world/crowd.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::bindings {
namespace {

// The angles of contact of the robots that touch something, by id.
using Angles = nb::typed<nb::tuple, double, nb::ellipsis>;

std::map<int, Angles> ContactAngles(const world::World& world) {
  std::map<int, Angles> angles;
  for (int i = 0; i < static_cast<int>(world.in_contact().size()); ++i) {
    if (world.in_contact()[i]) angles[i] = Angles(nb::tuple(nb::cast(world.contact_angles(i))));
  }
  return angles;
}

void StepByRows(world::World& world, const Triples& twists) {
  const auto* const rows = reinterpret_cast<const base::Twist*>(twists.data());
  world.Step({rows, rows + twists.shape(0)});
}

using SpeedRows = Array<const double, -1, 4>;

Array<double, -1, 4> ReachedSpeeds(const std::vector<world::DriveLimits>& drives, const SpeedRows& speeds,
                                   const Triples& twists, double dt) {
  const auto* const now = reinterpret_cast<const world::DriveSpeed*>(speeds.data());
  const auto* const commands = reinterpret_cast<const base::Twist*>(twists.data());
  return RowsOf<4>(
      world::ReachedSpeeds({now, now + speeds.shape(0)}, {commands, commands + twists.shape(0)}, drives, dt));
}

void BindParts(nb::module_& m) {
  nb::class_<world::Solid>(m, "Solid")
      .def(
          "__init__",
          [](world::Solid* self, const world::Polygon& outline_m, const std::vector<world::Polygon>& pieces_m) {
            new (self) world::Solid{outline_m, pieces_m};
          },
          "outline_m"_a, "pieces_m"_a);
  nb::class_<world::Door>(m, "Door").def(
      "__init__",
      [](world::Door* self, const world::Solid& leaf, bool closed, double time_s, double angle_rad,
         const base::Point& shift_m, const base::Point& hinge_m) {
        new (self) world::Door{leaf, closed, {time_s, angle_rad, shift_m, hinge_m}};
      },
      "leaf"_a, "closed"_a, nb::kw_only(), "time_s"_a = 0.0, "angle_rad"_a = 0.0, "shift_m"_a = base::Point(),
      "hinge_m"_a = base::Point());
  nb::class_<world::DoorState>(m, "DoorState")
      .def_ro("closed", &world::DoorState::closed)
      .def_ro("opening", &world::DoorState::opening)
      .def_prop_ro(
          "motion", [](const world::DoorState& state) { return world::NameOf(state.activity); },
          nb::for_getter(nb::sig("def motion(self) -> typing.Literal['still', 'opens', 'closes', 'held']")));
  nb::class_<world::DriveLimits>(m, "Drive")
      .def(
          "__init__",
          [](world::DriveLimits* self, const std::string& kind, double max_speed, double max_acceleration,
             double max_turn, double max_turn_acceleration, double wheelbase, double max_steering,
             double max_steering_rate) {
            new (self) world::DriveLimits{
                max_speed, max_turn,     max_acceleration, max_turn_acceleration, world::DriveKindOf(kind),
                wheelbase, max_steering, max_steering_rate};
          },
          nb::kw_only(), "kind"_a, "max_speed_mps"_a, "max_acceleration_mps2"_a, "max_turn_radps"_a = 0.0,
          "max_turn_acceleration_radps2"_a = 0.0, "wheelbase_m"_a = 0.0, "max_steering_rad"_a = 0.0,
          "max_steering_rate_radps"_a = 0.0);
  nb::class_<world::Robot>(m, "Robot")
      .def(
          "__init__",
          [](world::Robot* self, double radius_m, double mass_kg, const world::DriveLimits& drive,
             const base::Pose& start, const world::Polygon& footprint_m,
             bool present) { new (self) world::Robot{radius_m, mass_kg, drive, start, footprint_m, present}; },
          nb::kw_only(), "radius_m"_a, "mass_kg"_a, "drive"_a, "start"_a, "footprint_m"_a = world::Polygon(),
          "present"_a = true);
  nb::class_<world::MovableObject>(m, "MovableObject")
      .def(
          "__init__",
          [](world::MovableObject* self, double radius_m, double mass_kg, double friction, const base::Pose& start,
             const world::Polygon& corners_m) {
            new (self) world::MovableObject{radius_m, mass_kg, friction, start, corners_m};
          },
          nb::kw_only(), "radius_m"_a, "mass_kg"_a, "friction"_a, "start"_a, "corners_m"_a);
}

// Rows: x, y, target x, target y [m], speed [m/s], radius [m]; of bystanders x, y, radius [m].
Array<double, -1, 2> StepCrowd(const world::Crowd& crowd, const Array<const double, -1, 6>& walkers,
                               const Triples& others, const std::vector<bool>& closed, double time_s) {
  static_assert(sizeof(world::Walker) == 6 * sizeof(double) && sizeof(world::Bystander) == 3 * sizeof(double));
  const auto* const first = reinterpret_cast<const world::Walker*>(walkers.data());
  const auto* const bystanders = reinterpret_cast<const world::Bystander*>(others.data());
  const std::vector<world::Walker> all(first, first + walkers.shape(0));
  const std::vector<world::Bystander> standing(bystanders, bystanders + others.shape(0));
  return RowsOf<2>(crowd.Step(all, standing, closed, time_s));
}

void BindCrowd(nb::module_& m) {
  nb::class_<world::CrowdParameters>(m, "CrowdParameters")
      .def(
          "__init__",
          [](world::CrowdParameters* self, double time_gap, double neighbour_strength, double neighbour_range,
             double wall_strength, double wall_range, double longest_substep) {
            new (self) world::CrowdParameters{time_gap,      neighbour_strength, neighbour_range,
                                              wall_strength, wall_range,         longest_substep};
          },
          nb::kw_only(), "time_gap_s"_a, "neighbour_strength"_a, "neighbour_range_m"_a, "wall_strength"_a,
          "wall_range_m"_a, "longest_substep_s"_a);
  nb::class_<world::Crowd>(m, "Crowd")
      .def(nb::init<std::vector<world::Solid>, std::vector<world::Door>, world::CrowdParameters>(), "solids"_a,
           "doors"_a, "parameters"_a)
      .def("step", &StepCrowd, "walkers"_a, "others"_a, "closed"_a, "time_s"_a);
}

}  // namespace

void BindWorld(nb::module_&& m) {
  BindParts(m);
  m.def("reached_speeds", &ReachedSpeeds, "drives"_a, "speeds"_a, "twists"_a, "dt_s"_a);
  BindCrowd(m);
  nb::class_<world::World>(m, "World")
      .def(nb::init<std::vector<world::Solid>, std::vector<world::Door>, std::vector<world::Robot>, double, int,
                    std::vector<world::MovableObject>>(),
           "solids"_a, "doors"_a, "robots"_a, "step_s"_a, "substeps"_a,
           "objects"_a = std::vector<world::MovableObject>())
      .def("step", &StepByRows, "twists"_a)
      .def("step", &world::World::Step, "twists"_a)
      .def("object_poses", [](const world::World& world) { return RowsOf<3>(world.object_poses()); })
      .def("poses", [](const world::World& world) { return RowsOf<3>(world.poses()); })
      .def("twists", [](const world::World& world) { return RowsOf<3>(world.twists()); })
      .def("motions", [](const world::World& world) { return RowsOf<3>(world.motions()); })
      .def("in_contact", [](const world::World& world) { return FlagsOf(world.in_contact()); })
      .def("contact_angles", &ContactAngles)
      .def("set_pose", &world::World::SetPose, "robot_id"_a, "pose"_a)
      .def("remove_robot", &world::World::RemoveRobot, "robot_id"_a)
      .def("spawn_robot", &world::World::SpawnRobot, "robot_id"_a, "pose"_a)
      .def("present", [](const world::World& world) { return FlagsOf(world.present()); })
      .def("arrivals", &world::World::arrivals)
      .def("set_door", &world::World::SetDoorClosed, "door"_a, "closed"_a)
      .def_prop_ro("doors_version", &world::World::doors_version)
      .def("door_states", &world::World::door_states)
      .def("add_object", &world::World::AddObject, "added"_a)
      .def("remove_object", &world::World::RemoveObject, "index"_a)
      .def("set_object_pose", &world::World::SetObjectPose, "index"_a, "pose"_a)
      .def("reset", &world::World::Reset);
}

}  // namespace robotteamsim::bindings
