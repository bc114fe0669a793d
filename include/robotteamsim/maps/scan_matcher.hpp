#pragma once

#include <Eigen/Core>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/maps/log_odds_map.hpp"

namespace robotteamsim::maps {

/// How points are matched with the surfaces of a map.
struct MatcherParameters {
  double reach_m = 0.3;     ///< hits this near a point, along each axis, may be on its surface
  double kernel_m = 0.07;   ///< standard deviation of the weights of these hits, by their distance from the point
  double sigma_m = 0.02;    ///< standard deviation of a point from its surface
  double outlier_m = 0.03;  ///< a point that is this far from its surface has half the weight of one on it
};

/// The pose at which points fit a map.
struct Match {
  base::Pose pose;
  Eigen::Matrix3d information;  ///< of the points about x, y and yaw, the prior not included, in the frame of the map
  int points = 0;               ///< for how many a surface was found
  double misfit_m = 0.0;        ///< mean distance of these from their surfaces
};

/// Finds the pose at which the points of a scan fit the surfaces of a map: least squares of the distances between
/// points and lines [censi2008] with Cauchy weights, and of the difference from a predicted pose, by Gauss and Newton.
///
/// The line of a point is that of the mean hits of the cells around it, each weighted by its number of hits: noise
/// makes walls thicker, but not their mean. A point without a line, such as in a corner, does not count.
class ScanMatcher {
 public:
  /// Throws std::invalid_argument if a parameter is not positive.
  explicit ScanMatcher(const MatcherParameters& parameters);

  /// Args: points: in base_link.  predicted: in the frame of the map.  prior: its information about x, y and yaw.
  Match Align(const LogOddsMap& map, const std::vector<SurfacePoint>& points, const base::Pose& predicted,
              const Eigen::Matrix3d& prior) const;

 private:
  MatcherParameters parameters_;
};

}  // namespace robotteamsim::maps
