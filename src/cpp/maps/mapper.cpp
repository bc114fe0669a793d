#include "robotteamsim/maps/mapper.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/maps/pose_error.hpp"

namespace robotteamsim::maps {
namespace {

// Standard deviations that are added to those of the odometry, which may be 0 [m, rad].
constexpr double kSlack = 1e-3;
// A hit within so many cells of an occupied one agrees with the map.
constexpr int kNear = 3;
constexpr int kFewestHits = 10;  // in known places, for a scan to contradict the map
// If more of them do, the scan is matched again from farther away, and not inserted if that does not help.
constexpr double kDoubtful = 0.3;
constexpr double kWider = 3.0;       // how much farther
constexpr double kMemory = 2.0;      // the distance over which contradictions are averaged [m]
constexpr double kWayOfTurn = 0.02;  // what an update counts there at least: robots also turn on the spot [m]
// A submap is kept if it has changed so much of the map [m^2]: in known places, nothing is to be learnt from it.
constexpr double kNews = 4.0;
// The hits of a scan are not independent: so many next to each other are as good as one.
constexpr double kHitsPerError = 10.0;

Eigen::Matrix3d MatrixOf(const state::PoseCovariance& p) {
  Eigen::Matrix3d matrix;
  matrix << p.xx, p.xy, p.x_yaw, p.xy, p.yy, p.y_yaw, p.x_yaw, p.y_yaw, p.yaw_yaw;
  return matrix;
}

/// The covariance that a motion has added to that of the odometry, in `odom`. Only its diagonal: that of a robot whose
/// odometry reports any other covariance than the product's is then not negative, either.
Eigen::Vector3d Added(const OdometryReading& before, const OdometryReading& after) {
  const Eigen::Matrix3d carrying = Carrying(after.pose.x - before.pose.x, after.pose.y - before.pose.y);
  const Eigen::Matrix3d carried = carrying * MatrixOf(before.covariance) * carrying.transpose();
  return (MatrixOf(after.covariance) - carried).diagonal().cwiseMax(0.0);
}

MatcherParameters Matching(const MapperParameters& parameters, double wider) {
  return {parameters.reach_m * wider, parameters.kernel_m * wider, parameters.sigma_m, parameters.outlier_m * wider};
}

}  // namespace

Mapper::Mapper(const world::Fan& fan, double range_min_m, const MapperParameters& parameters, const base::Pose& start)
    : layout_{fan, range_min_m, parameters.beams},
      parameters_(parameters),
      matcher_(Matching(parameters, 1.0)),
      wide_matcher_(Matching(parameters, kWider)),
      map_(parameters.cell_m),
      submaps_(Matching(parameters, 1.0)),
      pose_(start),
      submap_(parameters.cell_m) {
  base::Check(start, "start");
  maps::Check(layout_);
  base::CheckPositive(parameters.update_m, "update_m");
  base::CheckPositive(parameters.update_rad, "update_rad");
  base::CheckPositive(parameters.submap_m, "submap_m");
  base::CheckPositive(parameters.lost_share, "lost_share");
  BeginSubmap();
}

std::optional<base::Pose> Mapper::DueAt(const base::Pose& odometry) const {
  if (!has_begun_) return pose_;
  const base::Pose motion = base::RelativePose(odometry_.pose, odometry);
  const bool has_turned = std::abs(motion.yaw) >= parameters_.update_rad;
  if (std::hypot(motion.x, motion.y) < parameters_.update_m && !has_turned) return std::nullopt;
  return base::Composed(pose_, motion);
}

bool Mapper::Step(const OdometryReading& odometry, const std::vector<float>& ranges_m,
                  const std::vector<std::uint8_t>& masked) {
  base::Check(odometry.pose, "the pose of the odometry");
  const state::PoseCovariance& p = odometry.covariance;
  for (const double entry : {p.xx, p.xy, p.x_yaw, p.yy, p.y_yaw, p.yaw_yaw}) base::Check(entry, "the covariance");
  CheckLengths(layout_, ranges_m, masked);
  now_ = odometry.pose;
  if (!has_begun_) {
    has_begun_ = true;
    odometry_ = odometry;
    Insert(ReadScan(layout_, ranges_m, masked));
    return true;
  }
  if (!DueAt(now_)) return false;
  Predict(odometry);
  Match(ReadScan(layout_, ranges_m, masked));
  driven_m_ += step_m_;
  if (driven_m_ >= parameters_.submap_m) CloseSubmap();
  return true;
}

/// Moves the pose as the odometry did; the covariances become those of the new pose.
void Mapper::Predict(const OdometryReading& odometry) {
  const base::Pose motion = base::RelativePose(odometry_.pose, odometry.pose);
  const Eigen::Matrix3d rotation = Turning(pose_.yaw - odometry_.pose.yaw);  // from `odom` to the map
  const Eigen::Vector3d variances = (Added(odometry_, odometry).array() + kSlack * kSlack).matrix();
  const Eigen::Matrix3d added = rotation * variances.asDiagonal() * rotation.transpose();
  step_m_ = std::hypot(motion.x, motion.y);
  const base::Pose predicted = base::Composed(pose_, motion);
  const Eigen::Matrix3d carrying = Carrying(predicted.x - pose_.x, predicted.y - pose_.y);
  covariance_ = carrying * covariance_ * carrying.transpose() + added;
  drift_ = carrying * drift_ * carrying.transpose();
  added_ = added;
  pose_ = predicted;
  odometry_ = odometry;
}

/// Returns which share of the hits in known places is where the map is free; none if there are few.
///
/// A hit next to something unknown does not count: before a robot comes along a wall, the beams that graze it free its
/// cells.
std::optional<double> Mapper::Contradiction(const std::vector<SurfacePoint>& hits, const base::Pose& pose) const {
  int agreeing = 0, contradicting = 0;
  for (const SurfacePoint& hit : hits) {
    const base::Point at = Moved(hit, pose).at;
    bool is_near = false;
    map_.ForHitsNear(at, kNear, [&](const HitCell&) { is_near = true; });
    if (is_near) {
      ++agreeing;
    } else if (const Cell cell = map_.CellOf(at); map_.LogOdds(cell) < 0 && !map_.IsUnknownNear(cell, kNear)) {
      ++contradicting;
    }
  }
  const int known = agreeing + contradicting;
  if (known < kFewestHits) return std::nullopt;
  return static_cast<double>(contradicting) / known;
}

/// Corrects the predicted pose by a scan, and inserts it if it fits.
void Mapper::Match(const Scan& scan) {
  const std::vector<SurfacePoint>& hits = scan.hits;
  const Eigen::Matrix3d prior = covariance_.inverse();
  maps::Match match = matcher_.Align(map_, hits, pose_, prior);
  std::optional<double> contradiction = Contradiction(hits, match.pose);
  if (contradiction.value_or(0.0) > kDoubtful) {
    const maps::Match wide = wide_matcher_.Align(map_, hits, pose_, prior);
    const maps::Match again = matcher_.Align(map_, hits, wide.pose, prior);
    const std::optional<double> of_wide = Contradiction(hits, again.pose);
    if (of_wide && *of_wide < *contradiction) {
      match = again;
      contradiction = of_wide;
    }
  }
  if (contradiction) {
    const double way_m = step_m_ + kWayOfTurn;
    contradiction_ += (1.0 - std::exp(-way_m / kMemory)) * (*contradiction - contradiction_);
    is_lost_ = contradiction_ > parameters_.lost_share;
  }
  if (contradiction.value_or(is_lost_ ? 1.0 : 0.0) > kDoubtful) {
    drift_ += added_;
    return;
  }
  drift_ += (added_.inverse() + match.information / kHitsPerError).inverse();
  pose_ = match.pose;
  covariance_ = (prior + match.information).inverse();
  if (!is_lost_) Insert(scan);
}

void Mapper::Insert(const Scan& scan) {
  const ScanCells cells = CellsOfScan(scan, pose_, parameters_.cell_m);
  map_.InsertCells(cells);
  submap_.InsertCells(cells, submap_origin_);
}

OccupancyGrid Mapper::TakeChanges(int factor) {
  CellBox changed = erased_;
  changed.Include(map_.changed());
  OccupancyGrid grid = map_.Occupancy(changed, factor);
  erased_ = {};
  map_.ForgetChanged();
  return grid;
}

void Mapper::BeginSubmap() {
  submap_ = LogOddsMap(parameters_.cell_m);
  // The cells of both maps coincide, so that a scan marks them once.
  submap_origin_ = map_.CheckedCellOf({pose_.x, pose_.y});
  submap_pose_ = {submap_origin_.col * parameters_.cell_m, submap_origin_.row * parameters_.cell_m, 0.0};
  drift_.setZero();
  driven_m_ = 0.0;
  changes_before_ = map_.changes();
}

void Mapper::CloseSubmap() {
  const double changed = static_cast<double>(map_.changes() - changes_before_);
  if (changed * parameters_.cell_m * parameters_.cell_m >= kNews) {
    Eigen::Matrix3d drift = submap_drift_;
    drift.diagonal().array() += kSlack * kSlack;
    if (submaps_.Add(submap_, submap_pose_, drift)) {
      pose_ = base::Composed(submaps_.poses().back(), base::RelativePose(submap_pose_, pose_));
      const CellBox before = map_.Everything();
      map_ = submaps_.Draw(parameters_.cell_m);
      erased_.Include(before);
    }
    submap_drift_ = drift_;
  } else {
    const Eigen::Matrix3d carrying = Carrying(pose_.x - submap_pose_.x, pose_.y - submap_pose_.y);
    submap_drift_ = carrying * submap_drift_ * carrying.transpose() + drift_;
  }
  BeginSubmap();
}

}  // namespace robotteamsim::maps
