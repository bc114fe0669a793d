// _core.sensing: ranges as they are reported, odometry and hearing.
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "mission_state.hpp"
#include "robotteamsim/sensing/range_report.hpp"
#include "robotteamsim/sensing/team_sensors.hpp"
#include "robotteamsim/sensing/voice_sensor.hpp"

namespace robotteamsim::bindings {
namespace {

using sensing::RangeLimits, sensing::TeamOdometry, sensing::TeamSensors, sensing::VoiceSensor;
using Rows = Array<const double, -1, -1>;
using Ranges = Array<float, -1, -1>;

Ranges Reported(const RangeLimits& limits, const Rows& ranges_m, const Rows& noise_m) {
  auto reported_m = NewTable<float>(ranges_m.shape(0), ranges_m.shape(1));
  sensing::Report(limits, TableOf(ranges_m), TableOf(noise_m), TableOf(reported_m));
  return reported_m;
}

TeamOdometry OdometryOf(const std::vector<std::array<double, 4>>& alphas, double step_s,
                        const std::vector<bool>& omni) {
  std::vector<sensing::OdometryModel> models;
  models.reserve(alphas.size());
  for (const auto& [alpha1, alpha2, alpha3, alpha4] : alphas) models.push_back({alpha1, alpha2, alpha3, alpha4});
  return {models, step_s, omni};
}

void BindTeam(nb::module_& m) {
  nb::class_<sensing::Lasers>(m, "Lasers")
      .def(
          "__init__",
          [](sensing::Lasers* self, const world::Fan& fan, const RangeLimits& limits, std::vector<int> robot_ids,
             std::shared_ptr<const world::FanCaster> caster) {
            new (self) sensing::Lasers{fan, std::move(caster), limits, std::move(robot_ids)};
          },
          "fan"_a, "limits"_a, "robot_ids"_a, "caster"_a.none() = nb::none());
  nb::class_<TeamSensors>(m, "TeamSensors")
      .def(
          "__init__",
          [](TeamSensors* self, std::vector<sensing::Lasers> lasers, const std::vector<std::array<double, 4>>& alphas,
             double step_s, const std::vector<bool>& omni) {
            new (self) TeamSensors(std::move(lasers), OdometryOf(alphas, step_s, omni));
          },
          "lasers"_a, "alphas"_a, "step_s"_a, "omni"_a)
      .def_prop_ro("beams", &TeamSensors::beams)
      .def("set_haze", &TeamSensors::SetHaze, "haze"_a.none())
      .def(
          "add_noise", [](TeamSensors& sensors, const Rows& noise) { sensors.AddNoise(TableOf(noise)); }, "noise"_a)
      .def_prop_ro("noise_left", &TeamSensors::noise_left)
      .def(
          "set_range_noise", [](TeamSensors& sensors, const Rows& noise_m) { sensors.SetRangeNoise(TableOf(noise_m)); },
          "noise_m"_a)
      .def(
          "restart", [](TeamSensors& sensors, int robot, const Rows& noise) { sensors.Restart(robot, TableOf(noise)); },
          "robot_id"_a, "noise"_a)
      .def(
          "read",
          [](TeamSensors& sensors, MissionState& state, const world::World& world) {
            sensors.Read(world, &state.one(), 0);
          },
          "state"_a, "world"_a)
      .def(
          "read_motion",
          [](TeamSensors& sensors, MissionState& state, const Triples& poses, const Triples& twists,
             const Triples& motions, const Array<const bool, -1>& in_contact,
             const std::map<int, std::vector<double>>& contact_angles, const std::vector<Rows>& ranges_m) {
            sensing::Motion motion{RecordsOf<base::Pose>(poses), RecordsOf<base::Twist>(twists),
                                   RecordsOf<base::Pose>(motions), ValuesOf<bool>(in_contact),
                                   std::vector<std::vector<double>>(in_contact.size())};
            for (const auto& [robot, angles] : contact_angles) motion.contact_angles.at(robot) = angles;
            std::vector<base::Table<const double>> tables;
            tables.reserve(ranges_m.size());
            for (const Rows& table : ranges_m) tables.push_back(TableOf(table));
            sensors.Read(motion, tables, &state.one(), 0);
          },
          "state"_a, "poses"_a, "twists"_a, "motions"_a, "in_contact"_a, "contact_angles_rad"_a, "ranges_m"_a);
}

void BindVoiceSensor(nb::module_& m) {
  nb::class_<VoiceSensor>(m, "VoiceSensor")
      .def(
          "__init__",
          [](VoiceSensor* self, const base::Point& origin_m, double resolution_m,
             const propagation::MapValues& levels_db, double radius_m) {
            const plan::GridShape grid{origin_m, resolution_m, static_cast<int>(levels_db.rows()),
                                       static_cast<int>(levels_db.cols())};
            new (self) VoiceSensor(grid, levels_db, radius_m);
          },
          "origin_m"_a, "resolution_m"_a, "levels_db"_a, "radius_m"_a)
      .def(
          "hear", [](VoiceSensor& sensor, MissionState& state) { sensor.Hear(&state.one(), 0); }, "state"_a);
}

}  // namespace

void BindSensing(nb::module_&& m) {
  nb::class_<RangeLimits>(m, "RangeLimits")
      .def(nb::init<double, double, double, double>(), nb::kw_only(), "range_min_m"_a, "range_max_m"_a, "too_near_m"_a,
           "no_return_m"_a);
  m.def("report", &Reported, "limits"_a, "ranges_m"_a, "noise_m"_a);
  m.def(
      "dim",
      [](const world::Fan& fan, const Triples& robots, const hazards::Haze& haze, double no_return_m,
         const Ranges& reported_m) {
        sensing::Dim(fan, RecordsOf<base::Pose>(robots), haze, no_return_m, TableOf(reported_m));
      },
      "fan"_a, "robots"_a, "haze"_a, "no_return_m"_a, "reported_m"_a);
  BindTeam(m);
  BindVoiceSensor(m);
}

}  // namespace robotteamsim::bindings
