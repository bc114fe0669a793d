#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "robotteamsim/base/fields.hpp"
#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/maps/log_odds_map.hpp"
#include "robotteamsim/maps/scan_matcher.hpp"
#include "robotteamsim/maps/submaps.hpp"
#include "robotteamsim/state/state.hpp"
#include "robotteamsim/world/fan_caster.hpp"

namespace robotteamsim::maps {

/// Defaults, units, ranges and meaning: scenario/controllers/mapping.py.
struct MapperParameters {
  double cell_m = 0.0;
  double update_m = 0.0;
  double update_rad = 0.0;
  int beams = 0;
  double reach_m = 0.0;
  double kernel_m = 0.0;
  double sigma_m = 0.0;
  double outlier_m = 0.0;
  double submap_m = 0.0;
  double lost_share = 0.0;
};

inline constexpr auto kMapperFields = std::make_tuple(
    base::Field{"cell_m", &MapperParameters::cell_m}, base::Field{"update_m", &MapperParameters::update_m},
    base::Field{"update_rad", &MapperParameters::update_rad}, base::Field{"beams", &MapperParameters::beams},
    base::Field{"reach_m", &MapperParameters::reach_m}, base::Field{"kernel_m", &MapperParameters::kernel_m},
    base::Field{"sigma_m", &MapperParameters::sigma_m}, base::Field{"outlier_m", &MapperParameters::outlier_m},
    base::Field{"submap_m", &MapperParameters::submap_m}, base::Field{"lost_share", &MapperParameters::lost_share});

/// The pose of the odometry and its covariance, both in `odom`.
struct OdometryReading {
  base::Pose pose;
  state::PoseCovariance covariance;
};

/// One robot's map of a building that it does not know, and its pose in it.
///
/// Every `update_m` or `update_rad`, a scan is matched with the map: from the pose that the odometry predicts, with the
/// covariance that the odometry says it has added since the last update. Then the scan is inserted. The same scans also
/// make submaps, whose graph moves the map where a robot comes back with an error, see Submaps. No random numbers: the
/// same input gives the same bits.
///
/// While the map contradicts what the robot sees, it inserts nothing. It is lost once that has lasted for some metres.
class Mapper {
 public:
  /// Args: fan: the robot's laser.  range_min_m: shorter ranges mean nothing.  start: the known first pose in the map.
  /// Throws std::invalid_argument if a parameter cannot be used.
  Mapper(const world::Fan& fan, double range_min_m, const MapperParameters& parameters, const base::Pose& start);

  /// Returns where the robot is by its odometry if the next step, with this pose of it, will be an update; else none.
  std::optional<base::Pose> DueAt(const base::Pose& odometry) const;

  /// Takes what the robot measures in a step; returns whether it was an update.
  /// Args: ranges_m: one per beam; those that are not below range_max are no returns.
  ///       masked: nonzero for beams to leave out, such as those that end at a teammate; empty: none.
  /// Throws std::invalid_argument if the odometry is not finite, or the arrays have another length.
  bool Step(const OdometryReading& odometry, const std::vector<float>& ranges_m,
            const std::vector<std::uint8_t>& masked);

  /// The pose of base_link in the map.
  base::Pose pose() const { return base::Composed(pose_, base::RelativePose(odometry_.pose, now_)); }

  /// The covariance of x, y and yaw at the last update, relative to the map near the robot.
  const Eigen::Matrix3d& covariance() const { return covariance_; }

  bool is_lost() const { return is_lost_; }

  /// Returns a part of the map, in squares as those of LogOddsMap::Occupancy, with all that has changed since the last
  /// call. Throws std::invalid_argument if the factor is below 1.
  OccupancyGrid TakeChanges(int factor);

  const LogOddsMap& map() const { return map_; }
  const Submaps& submaps() const { return submaps_; }

  /// The memory of the map and of its submaps [bytes].
  std::size_t Bytes() const { return map_.Bytes() + submap_.Bytes() + submaps_.Bytes(); }

 private:
  void Predict(const OdometryReading& odometry);
  std::optional<double> Contradiction(const std::vector<SurfacePoint>& hits, const base::Pose& pose) const;
  void Match(const Scan& scan);
  void Insert(const Scan& scan);
  void CloseSubmap();
  void BeginSubmap();

  ScanLayout layout_;
  MapperParameters parameters_;
  ScanMatcher matcher_, wide_matcher_;
  LogOddsMap map_;
  Submaps submaps_;
  CellBox erased_;  ///< what was known when the map was drawn again, since the last call of TakeChanges

  bool has_begun_ = false;
  base::Pose pose_;  ///< at the last update
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  OdometryReading odometry_;                         ///< at the last update
  base::Pose now_;                                   ///< by the odometry
  Eigen::Matrix3d added_ = Eigen::Matrix3d::Zero();  ///< what the odometry has added between the last two updates
  double step_m_ = 0.0;                              ///< driven between the last two updates
  double contradiction_ = 0.0;                       ///< share of beams that contradict the map, over the last metres
  bool is_lost_ = false;

  LogOddsMap submap_;  ///< that is being made
  Cell submap_origin_;
  base::Pose submap_pose_;                                  ///< of that cell's corner
  Eigen::Matrix3d submap_drift_ = Eigen::Matrix3d::Zero();  ///< covariance relative to the last one kept
  Eigen::Matrix3d drift_ = Eigen::Matrix3d::Zero();         ///< covariance of the robot's pose relative to it
  double driven_m_ = 0.0;                                   ///< since it began
  std::size_t changes_before_ = 0;                          ///< of the map, when it began
};

}  // namespace robotteamsim::maps
