#include "robotteamsim/maps/submaps.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "robotteamsim/maps/pose_error.hpp"

namespace robotteamsim::maps {
namespace {

constexpr std::size_t kMostPoints = 400;  // of a submap, that are matched
constexpr double kLeastOverlap = 0.3;     // of the points, for a match to count
constexpr int kFewestPoints = 40;
constexpr double kWorstMisfit = 0.03;  // [m]
// The points of a submap are not independent: so many next to each other are as good as one.
constexpr double kPointsPerError = 10.0;
constexpr double kFarthestCorrection = 0.3;  // [m]: a match from farther away may be with the wrong wall
// The square of an error in standard deviations, of 3 numbers, that 1 % of all right measurements exceed.
constexpr double kUnlikely = 11.3;

/// The mean hits of a submap, evenly thinned out.
std::vector<SurfacePoint> PointsOf(const std::vector<HitCell>& hits) {
  const std::size_t stride = hits.size() / kMostPoints + 1;
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < hits.size(); i += stride) points.push_back(hits[i].mean);
  return points;
}

/// Whether the circles around two grids overlap.
bool Overlap(const Submap& a, const base::Pose& a_pose, const Submap& b, const base::Pose& b_pose) {
  const auto circle = [](const plan::GridShape& shape, const base::Pose& pose) {
    const double width = shape.cols * shape.resolution_m, height = shape.rows * shape.resolution_m;
    const base::Pose center = base::Composed(pose, {shape.origin.x + 0.5 * width, shape.origin.y + 0.5 * height, 0.0});
    return std::make_pair(base::Point{center.x, center.y}, 0.5 * std::hypot(width, height));
  };
  const auto [a_center, a_radius] = circle(a.shape, a_pose);
  const auto [b_center, b_radius] = circle(b.shape, b_pose);
  return std::hypot(a_center.x - b_center.x, a_center.y - b_center.y) < a_radius + b_radius;
}

}  // namespace

OccupancyGrid Submap::Grid() const {
  return {shape, CellsOf(run_lengths, static_cast<std::size_t>(shape.rows) * shape.cols)};
}

Submaps::Submaps(const MatcherParameters& matcher) : matcher_(matcher) {}

bool Submaps::Add(const LogOddsMap& map, const base::Pose& pose, const Eigen::Matrix3d& drift) {
  const OccupancyGrid grid = Cropped(map.Occupancy());
  submaps_.push_back({grid.shape, RunLengths(grid.cells), map.Hits()});
  drifts_.push_back(drift);
  drawn_.push_back(pose);
  const std::size_t added = submaps_.size() - 1;
  if (added == 0) {
    graph_.Add(pose);
    return false;
  }
  const base::Pose motion = base::RelativePose(drawn_[added - 1], pose);
  graph_.Add(base::Composed(poses().back(), motion));
  graph_.Connect({added - 1, added, motion, drift.inverse()});
  const std::vector<SurfacePoint> points = PointsOf(submaps_.back().hits);
  std::vector<PoseGraph::Edge> loops;
  // The covariance of the pose in the frame of each other submap, from one submap to the next.
  Eigen::Matrix3d covariance = drift;
  for (std::size_t other = added - 1; other-- > 0;) {
    const base::Pose next = base::RelativePose(drawn_[other], drawn_[other + 1]);
    const base::Pose last = base::RelativePose(drawn_[other], pose);
    const Eigen::Matrix3d carrying = Carrying(last.x - next.x, last.y - next.y), turning = Turning(next.yaw);
    covariance = carrying * drifts_[other + 1] * carrying.transpose() + turning * covariance * turning.transpose();
    if (!Overlap(submaps_[other], drawn_[other], submaps_.back(), pose)) continue;
    const auto loop = Loop(other, points, covariance.inverse(), map.cell_m());
    if (loop) loops.push_back(*loop);
  }
  Connect(std::move(loops));
  if (!HaveMoved()) return false;
  drawn_ = poses();
  return true;
}

/// Returns the measurement of the last submap in the frame of another one; none if their surfaces do not fit.
std::optional<PoseGraph::Edge> Submaps::Loop(std::size_t other, const std::vector<SurfacePoint>& points,
                                             const Eigen::Matrix3d& prior, double cell_m) const {
  const std::size_t last = submaps_.size() - 1;
  const base::Pose expected = base::RelativePose(drawn_[other], drawn_[last]);
  LogOddsMap surfaces(cell_m);
  surfaces.AddHits(submaps_[other].hits, {});
  const Match match = matcher_.Align(surfaces, points, expected, prior);
  const double correction = std::hypot(match.pose.x - expected.x, match.pose.y - expected.y);
  const auto overlap = static_cast<double>(match.points) / static_cast<double>(points.size());
  if (match.points < kFewestPoints || overlap < kLeastOverlap) return std::nullopt;
  if (match.misfit_m > kWorstMisfit || correction > kFarthestCorrection) return std::nullopt;
  return PoseGraph::Edge{other, last, match.pose, match.information / kPointsPerError};
}

/// Adds measurements, but those that contradict the others.
void Submaps::Connect(std::vector<PoseGraph::Edge> loops) {
  const PoseGraph without = graph_;
  while (!loops.empty()) {
    graph_ = without;
    for (const PoseGraph::Edge& loop : loops) graph_.Connect(loop);
    graph_.Optimise();
    const std::vector<double> errors = graph_.Errors();
    if (*std::max_element(errors.begin(), errors.end()) <= kUnlikely) return;
    const auto first = errors.end() - static_cast<std::ptrdiff_t>(loops.size());
    loops.erase(loops.begin() + (std::max_element(first, errors.end()) - first));
  }
  graph_ = without;
}

bool Submaps::HaveMoved() const {
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    const base::Pose moved = base::RelativePose(drawn_[i], poses()[i]);
    const plan::GridShape& shape = submaps_[i].shape;
    const double radius = std::max(shape.rows, shape.cols) * shape.resolution_m;
    if (std::hypot(moved.x, moved.y) + std::abs(moved.yaw) * radius > kMoved) return true;
  }
  return false;
}

LogOddsMap Submaps::Draw(double cell_m) const {
  LogOddsMap map(cell_m);
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    map.AddFree(submaps_[i].Grid(), poses()[i]);
    map.AddHits(submaps_[i].hits, poses()[i]);
  }
  return map;
}

std::size_t Submaps::Bytes() const {
  std::size_t bytes = 0;
  for (const Submap& submap : submaps_) bytes += submap.run_lengths.size() + submap.hits.size() * sizeof(HitCell);
  return bytes;
}

}  // namespace robotteamsim::maps
