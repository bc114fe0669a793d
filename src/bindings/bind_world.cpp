// _core.world: robots, walls, doors and objects.
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/world/crowd.hpp"
#include "robotteamsim/world/fan_caster.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::bindings {
namespace {

using world::Door, world::DriveLimits, world::FanCaster, world::MovableObject, world::Polygon, world::Solid,
    world::World;

// The angles of contact of the robots that touch something, by id.
using Angles = nb::typed<nb::tuple, double, nb::ellipsis>;

std::map<int, Angles> ContactAngles(const World& world) {
  std::map<int, Angles> angles;
  for (int i = 0; i < static_cast<int>(world.in_contact().size()); ++i) {
    if (world.in_contact()[i]) angles[i] = Angles(nb::tuple(nb::cast(world.contact_angles(i))));
  }
  return angles;
}

void BindParts(nb::module_& m) {
  nb::class_<Solid>(m, "Solid").def(nb::init<Polygon, std::vector<Polygon>>(), "outline_m"_a, "pieces_m"_a);
  nb::class_<Door>(m, "Door").def(
      "__init__",
      [](Door* self, const Solid& leaf, bool closed, double time_s, double angle_rad, const base::Point& shift_m,
         const base::Point& hinge_m) {
        new (self) Door{leaf, closed, {time_s, angle_rad, shift_m, hinge_m}};
      },
      "leaf"_a, "closed"_a, nb::kw_only(), "time_s"_a = 0.0, "angle_rad"_a = 0.0, "shift_m"_a = base::Point(),
      "hinge_m"_a = base::Point());
  nb::class_<world::DoorState>(m, "DoorState")
      .def_ro("closed", &world::DoorState::closed)
      .def_ro("opening", &world::DoorState::opening)
      .def_prop_ro(
          "motion", [](const world::DoorState& state) { return world::NameOf(state.activity); },
          nb::for_getter(nb::sig("def motion(self) -> typing.Literal['still', 'opens', 'closes', 'held']")));
  nb::class_<DriveLimits>(m, "Drive")
      .def(
          "__init__",
          [](DriveLimits* self, const std::string& kind, double max_speed, double max_acceleration, double max_turn,
             double max_turn_acceleration, double wheelbase, double max_steering, double max_steering_rate) {
            new (self)
                DriveLimits{max_speed, max_turn,     max_acceleration, max_turn_acceleration, world::DriveKindOf(kind),
                            wheelbase, max_steering, max_steering_rate};
          },
          nb::kw_only(), "kind"_a, "max_speed_mps"_a, "max_acceleration_mps2"_a, "max_turn_radps"_a = 0.0,
          "max_turn_acceleration_radps2"_a = 0.0, "wheelbase_m"_a = 0.0, "max_steering_rad"_a = 0.0,
          "max_steering_rate_radps"_a = 0.0);
  nb::class_<world::Robot>(m, "Robot")
      .def(nb::init<double, double, DriveLimits, base::Pose, Polygon, bool>(), nb::kw_only(), "radius_m"_a, "mass_kg"_a,
           "drive"_a, "start"_a, "footprint_m"_a = Polygon(), "present"_a = true);
  nb::class_<MovableObject>(m, "MovableObject")
      .def(nb::init<double, double, double, base::Pose, Polygon>(), nb::kw_only(), "radius_m"_a, "mass_kg"_a,
           "friction"_a, "start"_a, "corners_m"_a);
}

void BindFan(nb::module_& m) {
  nb::class_<world::Fan>(m, "Fan").def(nb::init<int, double, double, double, double, double>(), nb::kw_only(),
                                       "beams"_a, "angle_min_rad"_a, "angle_max_rad"_a, "forward_m"_a, "left_m"_a,
                                       "range_max_m"_a);
  nb::class_<FanCaster>(m, "FanCaster")
      .def(nb::init<const world::Fan&, const std::vector<Solid>&, const std::vector<Door>&>(), "fan"_a, "solids"_a,
           "doors"_a)
      .def(
          "cast",
          [](const FanCaster& caster, const World& world, const std::vector<int>& robot_ids) {
            auto ranges_m = NewTable<double>(robot_ids.size(), static_cast<std::size_t>(caster.fan().beams));
            caster.Cast(world, robot_ids, TableOf(ranges_m));
            return ranges_m;
          },
          "world"_a, "robot_ids"_a);
}

void BindCrowd(nb::module_& m) {
  nb::class_<world::CrowdParameters>(m, "CrowdParameters")
      .def(nb::init<double, double, double, double, double, double>(), nb::kw_only(), "time_gap_s"_a,
           "neighbour_strength"_a, "neighbour_range_m"_a, "wall_strength"_a, "wall_range_m"_a, "longest_substep_s"_a);
  nb::class_<world::Crowd>(m, "Crowd")
      .def(nb::init<std::vector<Solid>, std::vector<Door>, world::CrowdParameters>(), "solids"_a, "doors"_a,
           "parameters"_a)
      // Rows: x, y, target x, target y [m], speed [m/s], radius [m]; of others x, y, radius [m].
      .def(
          "step",
          [](const world::Crowd& crowd, const Array<const double, -1, 6>& walkers, const Triples& others,
             const std::vector<bool>& closed, double time_s) {
            return RowsOf<2>(
                crowd.Step(RecordsOf<world::Walker>(walkers), RecordsOf<world::Bystander>(others), closed, time_s));
          },
          "walkers"_a, "others"_a, "closed"_a, "time_s"_a);
}

}  // namespace

void BindWorld(nb::module_&& m) {
  BindParts(m);
  m.def(
      "reached_speeds",
      [](const std::vector<DriveLimits>& drives, const Array<const double, -1, 4>& speeds, const Triples& twists,
         double dt_s) {
        return RowsOf<4>(
            world::ReachedSpeeds(RecordsOf<world::DriveSpeed>(speeds), RecordsOf<base::Twist>(twists), drives, dt_s));
      },
      "drives"_a, "speeds"_a, "twists"_a, "dt_s"_a);
  BindFan(m);
  BindCrowd(m);
  nb::class_<World>(m, "World")
      .def(nb::init<std::vector<Solid>, std::vector<Door>, std::vector<world::Robot>, double, int,
                    std::vector<MovableObject>>(),
           "solids"_a, "doors"_a, "robots"_a, "step_s"_a, "substeps"_a, "objects"_a = std::vector<MovableObject>())
      .def(
          "step", [](World& world, const Triples& twists) { world.Step(RecordsOf<base::Twist>(twists)); }, "twists"_a)
      .def("step", &World::Step, "twists"_a)
      .def("object_poses", [](const World& world) { return RowsOf<3>(world.object_poses()); })
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
      .def("add_object", &World::AddObject, "added"_a)
      .def("remove_object", &World::RemoveObject, "index"_a)
      .def("set_object_pose", &World::SetObjectPose, "index"_a, "pose"_a)
      .def("reset", &World::Reset);
}

}  // namespace robotteamsim::bindings
