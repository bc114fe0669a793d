// _core.sensing: lasers, odometry and hearing.
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/sensing/team_sensors.hpp"
#include "robotteamsim/sensing/voice_sensor.hpp"

namespace nanobind::detail {

template <>
struct type_caster<robotteamsim::sensing::VoiceReading> {
  NB_TYPE_CASTER(robotteamsim::sensing::VoiceReading, const_name("robotteamsim.sensing.readings.VoiceReading"))

  static handle from_cpp(const robotteamsim::sensing::VoiceReading& heard, rv_policy /*policy*/,
                         cleanup_list* /*cleanup*/) {
    // Kept for as long as the interpreter runs.
    static const handle record =
        object(module_::import_("robotteamsim.sensing.readings").attr("VoiceReading")).release();
    return record(heard.level_db, heard.heard, heard.local_best, heard.local_best_level_db).release();
  }
};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using NoiseRows = Array<const double, -1, -1>;

const double* CheckedNoise(const NoiseRows& noise_m, const sensing::Laser& laser, const std::vector<int>& robots) {
  if (noise_m.size() == 0) return nullptr;
  if (noise_m.shape(0) != robots.size() || noise_m.shape(1) != static_cast<std::size_t>(laser.NumBeams())) {
    throw std::invalid_argument("noise must have one value per beam");
  }
  return noise_m.data();
}

// The nearest return of each robot's laser, as a sonar reports it.
Array<float, -1> Nearest(const sensing::Laser& laser, const world::World& world, const std::vector<int>& robot_ids,
                         const Array<const double, -1>& noise_m) {
  if (noise_m.size() != 0 && noise_m.size() != robot_ids.size()) {
    throw std::invalid_argument("noise must have one value per robot");
  }
  auto nearest = NewArray<float, -1>({robot_ids.size()});
  for (std::size_t i = 0; i < robot_ids.size(); ++i) {
    const std::vector<double> ranges = laser.Scan(world, robot_ids[i]);
    laser.Report({*std::min_element(ranges.begin(), ranges.end())}, noise_m.size() == 0 ? nullptr : noise_m.data() + i,
                 nearest.data() + i);
  }
  return nearest;
}

template <typename Record>
std::vector<Record> RecordsOf(const Triples& rows) {
  static_assert(sizeof(Record) == 3 * sizeof(double));
  const auto* const records = reinterpret_cast<const Record*>(rows.data());
  return {records, records + rows.shape(0)};
}

constexpr nb::ssize_t kReadingSize = 24;  // doubles of a RobotReading

float* CheckedRanges(const Array<float, -1, -1>& ranges_m, const sensing::TeamLaser& laser) {
  if (ranges_m.shape(0) != laser.robots.size() ||
      ranges_m.shape(1) != static_cast<std::size_t>(laser.laser->NumBeams())) {
    throw std::invalid_argument("ranges must have one row per robot and one column per beam");
  }
  return ranges_m.data();
}

// Writes into `readings` and `ranges_m`.
void Read(sensing::TeamSensors& sensors, const world::World& world, const Triples& odometry_noise,
          const std::vector<NoiseRows>& laser_noise_m, const Array<double, -1, kReadingSize>& readings,
          const std::vector<Array<float, -1, -1>>& ranges_m) {
  static_assert(sizeof(sensing::RobotReading) == kReadingSize * sizeof(double));
  const std::vector<sensing::TeamLaser>& lasers = sensors.lasers();
  if (ranges_m.size() != lasers.size()) throw std::invalid_argument("each kind of laser must have its ranges");
  if (!laser_noise_m.empty() && laser_noise_m.size() != lasers.size()) {
    throw std::invalid_argument("each kind of laser must have its noise");
  }
  if (readings.shape(0) != world.poses().size()) throw std::invalid_argument("readings must have one row per robot");
  std::vector<sensing::TeamScans> scans;
  scans.reserve(lasers.size());
  for (std::size_t i = 0; i < lasers.size(); ++i) {
    const double* const noise =
        laser_noise_m.empty() ? nullptr : CheckedNoise(laser_noise_m[i], *lasers[i].laser, lasers[i].robots);
    scans.push_back({CheckedRanges(ranges_m[i], lasers[i]), noise});
  }
  sensors.Read(world, RecordsOf<sensing::Odometry::Noise>(odometry_noise),
               reinterpret_cast<sensing::RobotReading*>(readings.data()), scans);
}

Array<float, -1, -1> Scan(const sensing::Laser& laser, const world::World& world, const std::vector<int>& robot_ids,
                          const NoiseRows& noise_m) {
  auto ranges = NewArray<float, -1, -1>({robot_ids.size(), static_cast<std::size_t>(laser.NumBeams())});
  sensing::ScanTeam(laser, world, robot_ids, CheckedNoise(noise_m, laser, robot_ids), ranges.data());
  return ranges;
}

// Changes `ranges_m` in place.
void Dim(const sensing::Laser& laser, const world::World& world, const std::vector<int>& robot_ids,
         const hazards::Haze& haze, const Array<float, -1, -1>& ranges_m) {
  if (ranges_m.shape(0) != robot_ids.size() || ranges_m.shape(1) != static_cast<std::size_t>(laser.NumBeams())) {
    throw std::invalid_argument("ranges must have one row per robot and one column per beam");
  }
  for (std::size_t i = 0; i < robot_ids.size(); ++i) {
    laser.Dim(world, robot_ids[i], haze, ranges_m.data() + i * static_cast<std::size_t>(laser.NumBeams()));
  }
}

void BindOdometry(nb::module_& m) {
  nb::class_<sensing::TeamOdometry>(m, "TeamOdometry")
      .def(
          "__init__",
          [](sensing::TeamOdometry* self, const std::vector<std::array<double, 4>>& alphas, double step_s,
             const std::vector<bool>& omni) {
            std::vector<sensing::OdometryModel> models;
            models.reserve(alphas.size());
            for (const auto& [alpha1, alpha2, alpha3, alpha4] : alphas)
              models.push_back({alpha1, alpha2, alpha3, alpha4});
            new (self) sensing::TeamOdometry(models, step_s, omni);
          },
          "alphas"_a, "step_s"_a, "omni"_a)
      .def("restart", &sensing::TeamOdometry::Restart, "robot_id"_a)
      .def(
          "step",
          [](sensing::TeamOdometry& odometry, const Triples& motions, const Triples& twists, const Triples& noise) {
            return RowsOf<16>(odometry.Step(RecordsOf<base::Pose>(motions), RecordsOf<base::Twist>(twists),
                                            RecordsOf<sensing::Odometry::Noise>(noise)));
          },
          "motions"_a, "twists"_a, "noise"_a);
}

void BindTeam(nb::module_& m) {
  nb::class_<sensing::TeamSensors>(m, "TeamSensors")
      .def(
          "__init__",
          [](sensing::TeamSensors* self, std::shared_ptr<sensing::TeamOdometry> odometry,
             const std::vector<std::pair<std::shared_ptr<const sensing::Laser>, std::vector<int>>>& lasers) {
            std::vector<sensing::TeamLaser> kinds;
            kinds.reserve(lasers.size());
            for (const auto& [laser, robots] : lasers) kinds.push_back({laser, robots});
            new (self) sensing::TeamSensors(std::move(odometry), std::move(kinds));
          },
          "odometry"_a, "lasers"_a)
      .def("read", &Read, "world"_a, "odometry_noise"_a, "laser_noise_m"_a, "readings"_a, "ranges_m"_a);
}

void BindVoiceSensor(nb::module_& m) {
  nb::class_<sensing::VoiceSensor>(m, "VoiceSensor")
      .def(
          "__init__",
          [](sensing::VoiceSensor* self, const base::Point& origin_m, double resolution_m,
             const propagation::MapValues& levels_db, double radius_m) {
            const plan::GridShape grid{origin_m, resolution_m, static_cast<int>(levels_db.rows()),
                                       static_cast<int>(levels_db.cols())};
            new (self) sensing::VoiceSensor(grid, levels_db, radius_m);
          },
          "origin_m"_a, "resolution_m"_a, "levels_db"_a, "radius_m"_a)
      .def(
          "hear",
          [](sensing::VoiceSensor& sensor, const Points& positions_m) { return sensor.Hear(PointsOf(positions_m)); },
          "positions_m"_a);
}

}  // namespace

void BindSensing(nb::module_&& m) {
  nb::class_<sensing::Laser>(m, "Laser")
      .def(
          "__init__",
          [](sensing::Laser* self, const std::vector<world::Solid>& solids, const std::vector<world::Door>& doors,
             int beams, double angle_min_rad, double angle_max_rad, double forward_m, double range_min_m,
             double range_max_m, double too_near_m, double no_return_m, double left_m) {
            new (self) sensing::Laser({beams, angle_min_rad, angle_max_rad, forward_m, range_min_m, range_max_m,
                                       too_near_m, no_return_m, left_m},
                                      solids, doors);
          },
          "solids"_a, "doors"_a, nb::kw_only(), "beams"_a, "angle_min_rad"_a, "angle_max_rad"_a, "forward_m"_a,
          "range_min_m"_a, "range_max_m"_a, "too_near_m"_a, "no_return_m"_a, "left_m"_a)
      .def("scan", &Scan, "world"_a, "robot_ids"_a, "noise_m"_a)
      .def("dim", &Dim, "world"_a, "robot_ids"_a, "haze"_a, "ranges_m"_a)
      .def("nearest", &Nearest, "world"_a, "robot_ids"_a, "noise_m"_a);
  BindOdometry(m);
  BindTeam(m);
  BindVoiceSensor(m);
}

}  // namespace robotteamsim::bindings
