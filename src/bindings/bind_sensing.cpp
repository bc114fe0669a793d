// _core.sensing: lasers, odometry and hearing.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/sensing/team_sensors.hpp"
#include "robotteamsim/sensing/voice_sensor.hpp"

namespace nanobind::detail {

namespace sensing = robotteamsim::sensing;

template <>
struct type_caster<sensing::TeamLaser>
    : TupleCaster<sensing::TeamLaser, &sensing::TeamLaser::laser, &sensing::TeamLaser::robots> {};

template <>
struct type_caster<sensing::VoiceReading> {
  NB_TYPE_CASTER(sensing::VoiceReading, const_name("robotteamsim.sensing.readings.VoiceReading"))

  static handle from_cpp(const sensing::VoiceReading& heard, rv_policy /*policy*/, cleanup_list* /*cleanup*/) {
    // Kept for as long as the interpreter runs.
    static const handle record =
        object(module_::import_("robotteamsim.sensing.readings").attr("VoiceReading")).release();
    return record(heard.level_db, heard.heard, heard.local_best, heard.local_best_level_db).release();
  }
};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using sensing::Laser, sensing::TeamOdometry, sensing::TeamSensors, sensing::VoiceSensor;
using world::World;
using NoiseRows = Array<const double, -1, -1>;
using Ranges = Array<float, -1, -1>;

constexpr nb::ssize_t kReadingSize = 24;  // doubles of a RobotReading

template <typename Value>
std::vector<base::Table<Value>> TablesOf(const std::vector<Array<Value, -1, -1>>& arrays) {
  std::vector<base::Table<Value>> tables;
  tables.reserve(arrays.size());
  for (const Array<Value, -1, -1>& rows : arrays) tables.push_back(TableOf(rows));
  return tables;
}

// Writes into `readings` and `ranges_m`.
void Read(TeamSensors& sensors, const World& world, const Triples& odometry_noise,
          const std::vector<NoiseRows>& laser_noise_m, const Array<double, -1, kReadingSize>& readings,
          const std::vector<Ranges>& ranges_m) {
  static_assert(sizeof(sensing::RobotReading) == kReadingSize * sizeof(double));
  if (readings.shape(0) != world.poses().size()) throw std::invalid_argument("readings must have one row per robot");
  sensors.Read(world, RecordsOf<sensing::Odometry::Noise>(odometry_noise), TablesOf(laser_noise_m),
               reinterpret_cast<sensing::RobotReading*>(readings.data()), TablesOf(ranges_m));
}

Ranges Scan(const Laser& laser, const World& world, const std::vector<int>& robot_ids, const NoiseRows& noise_m) {
  const std::size_t robots = robot_ids.size(), beams = static_cast<std::size_t>(laser.NumBeams());
  std::vector<float> ranges(robots * beams);
  sensing::ScanTeam(laser, world, robot_ids, TableOf(noise_m), {ranges.data(), robots, beams});
  return ArrayOf<float, -1, -1>(std::move(ranges), {robots, beams});
}

void BindOdometry(nb::module_& m) {
  nb::class_<TeamOdometry>(m, "TeamOdometry")
      .def(
          "__init__",
          [](TeamOdometry* self, const std::vector<std::array<double, 4>>& alphas, double step_s,
             const std::vector<bool>& omni) {
            std::vector<sensing::OdometryModel> models;
            models.reserve(alphas.size());
            for (const auto& [alpha1, alpha2, alpha3, alpha4] : alphas)
              models.push_back({alpha1, alpha2, alpha3, alpha4});
            new (self) TeamOdometry(models, step_s, omni);
          },
          "alphas"_a, "step_s"_a, "omni"_a)
      .def("restart", &TeamOdometry::Restart, "robot_id"_a)
      .def(
          "step",
          [](TeamOdometry& odometry, const Triples& motions, const Triples& twists, const Triples& noise) {
            return RowsOf<16>(odometry.Step(RecordsOf<base::Pose>(motions), RecordsOf<base::Twist>(twists),
                                            RecordsOf<sensing::Odometry::Noise>(noise)));
          },
          "motions"_a, "twists"_a, "noise"_a);
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
          "hear",
          [](VoiceSensor& sensor, const Points& positions_m) {
            return sensor.Hear(RecordsOf<base::Point>(positions_m));
          },
          "positions_m"_a);
}

}  // namespace

void BindSensing(nb::module_&& m) {
  nb::class_<Laser>(m, "Laser")
      .def(
          "__init__",
          [](Laser* self, const std::vector<world::Solid>& solids, const std::vector<world::Door>& doors, int beams,
             double angle_min_rad, double angle_max_rad, double forward_m, double range_min_m, double range_max_m,
             double too_near_m, double no_return_m, double left_m) {
            new (self) Laser({beams, angle_min_rad, angle_max_rad, forward_m, range_min_m, range_max_m, too_near_m,
                              no_return_m, left_m},
                             solids, doors);
          },
          "solids"_a, "doors"_a, nb::kw_only(), "beams"_a, "angle_min_rad"_a, "angle_max_rad"_a, "forward_m"_a,
          "range_min_m"_a, "range_max_m"_a, "too_near_m"_a, "no_return_m"_a, "left_m"_a)
      .def("scan", &Scan, "world"_a, "robot_ids"_a, "noise_m"_a)
      .def(
          "dim",
          [](const Laser& laser, const World& world, const std::vector<int>& robot_ids, const hazards::Haze& haze,
             const Ranges& ranges_m) { sensing::DimTeam(laser, world, robot_ids, haze, TableOf(ranges_m)); },
          "world"_a, "robot_ids"_a, "haze"_a, "ranges_m"_a)
      .def(
          "nearest",
          [](const Laser& laser, const World& world, const std::vector<int>& robot_ids,
             const Array<const double, -1>& noise_m) {
            return ArrayOf(sensing::ScanNearest(laser, world, robot_ids, ValuesOf<double>(noise_m)));
          },
          "world"_a, "robot_ids"_a, "noise_m"_a);
  BindOdometry(m);
  nb::class_<TeamSensors>(m, "TeamSensors")
      .def(nb::init<std::shared_ptr<TeamOdometry>, std::vector<sensing::TeamLaser>>(), "odometry"_a, "lasers"_a)
      .def("read", &Read, "world"_a, "odometry_noise"_a, "laser_noise_m"_a, "readings"_a, "ranges_m"_a);
  BindVoiceSensor(m);
}

}  // namespace robotteamsim::bindings
