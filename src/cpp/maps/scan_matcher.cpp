#include "robotteamsim/maps/scan_matcher.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

constexpr int kMostIterations = 4;
constexpr double kSmallStep = 3e-4;  // [m], [rad]: no further step is made
constexpr int kFewestCells = 3;      // of a line
// The variance across a line is at most this part of that along it.
// Of the angle between the normals of hits on the same surface.
constexpr double kLeastCos = 0.5;
constexpr double kThinnest = 0.15;

/// A straight line: a point of it, and its unit normal.
struct Line {
  base::Point through;
  base::Point normal;
};

/// Returns the line of the surface around a point; none if the hits there do not lie along one.
std::optional<Line> LineNear(const LogOddsMap& map, const SurfacePoint& point, const MatcherParameters& parameters) {
  const int reach = static_cast<int>(parameters.reach_m / map.cell_m() + 0.5);
  const double per_squared = 0.5 / (parameters.kernel_m * parameters.kernel_m);
  int cells = 0;
  double weight = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  map.ForHitsNear(point.at, reach, [&](const HitCell& hits) {
    const base::Point &normal = hits.mean.normal, &own = point.normal;
    if (!(normal.x * own.x + normal.y * own.y > kLeastCos)) return;  // another wall, or the other side of this one
    const double dx = hits.mean.at.x - point.at.x, dy = hits.mean.at.y - point.at.y;
    const double share = hits.count * std::exp(-(dx * dx + dy * dy) * per_squared);
    ++cells;
    weight += share;
    x += share * dx;
    y += share * dy;
    xx += share * dx * dx;
    xy += share * dx * dy;
    yy += share * dy * dy;
  });
  if (cells < kFewestCells) return std::nullopt;
  x /= weight;
  y /= weight;
  xx = xx / weight - x * x;
  xy = xy / weight - x * y;
  yy = yy / weight - y * y;
  // The eigenvalues of a symmetric 2 x 2 matrix, and the direction of the larger one.
  const double mean = 0.5 * (xx + yy), half = std::hypot(0.5 * (xx - yy), xy);
  if (!(mean - half <= kThinnest * (mean + half))) return std::nullopt;
  const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return Line{{point.at.x + x, point.at.y + y}, {-std::sin(along), std::cos(along)}};
}

}  // namespace

ScanMatcher::ScanMatcher(const MatcherParameters& parameters) : parameters_(parameters) {
  base::CheckPositive(parameters.reach_m, "reach_m");
  base::CheckPositive(parameters.kernel_m, "kernel_m");
  base::CheckPositive(parameters.sigma_m, "sigma_m");
  base::CheckPositive(parameters.outlier_m, "outlier_m");
}

Match ScanMatcher::Align(const LogOddsMap& map, const std::vector<SurfacePoint>& points, const base::Pose& predicted,
                         const Eigen::Matrix3d& prior) const {
  Match match{predicted, Eigen::Matrix3d::Zero()};
  for (int step = 0; step < kMostIterations; ++step) {
    const base::Pose& pose = match.pose;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double sum_m = 0.0;
    match.points = 0;
    for (const SurfacePoint& point : points) {
      const SurfacePoint moved = Moved(point, pose);
      const base::Point& at = moved.at;
      const std::optional<Line> line = LineNear(map, moved, parameters_);
      if (!line) continue;
      const auto& [through, normal] = *line;
      const double distance = normal.x * (at.x - through.x) + normal.y * (at.y - through.y);
      const Eigen::Vector3d slope(normal.x, normal.y, normal.y * (at.x - pose.x) - normal.x * (at.y - pose.y));
      const double far = distance / parameters_.outlier_m;
      const double weight = 1.0 / ((1.0 + far * far) * parameters_.sigma_m * parameters_.sigma_m);
      information += weight * slope * slope.transpose();
      gradient += weight * distance * slope;
      sum_m += std::abs(distance);
      ++match.points;
    }
    match.information = information;
    match.misfit_m = match.points > 0 ? sum_m / match.points : 0.0;
    const Eigen::Vector3d from_prior(pose.x - predicted.x, pose.y - predicted.y,
                                     base::NormaliseAngle(pose.yaw - predicted.yaw));
    const Eigen::Vector3d change = (information + prior).ldlt().solve(-gradient - prior * from_prior);
    match.pose = {pose.x + change.x(), pose.y + change.y(), base::NormaliseAngle(pose.yaw + change.z())};
    if (change.cwiseAbs().maxCoeff() < kSmallStep) break;
  }
  return match;
}

}  // namespace robotteamsim::maps
