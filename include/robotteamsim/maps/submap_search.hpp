#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::maps {

/// Finds where the points of a submap may lie in a map: at any place and in any direction, by branch and bound
/// [hess2016, Algorithm 3].
///
/// It returns all poses that fit well, and not the best one alone: a building that looks the same in two places has
/// two.
class SubmapSearch {
 public:
  struct Limits {
    double least_share = 0.5;   ///< of points on occupied cells, for a pose to count
    double ratio = 0.8;         ///< the least share relative to that of the best pose
    double distinct_m = 0.5;    ///< poses nearer than this to a better one, and turned less, are the same
    double distinct_rad = 0.3;  ///< see distinct_m
    int most = 200;             ///< the search stops at so many poses, which then need not be the best
  };

  /// A pose of the submap in the map, and the share of its points that lie on occupied cells.
  struct Match {
    base::Pose pose;
    double share;
  };

  /// Args: occupied: nonzero in occupied cells, row by row.
  ///       tolerance_m: how far from the centre of an occupied cell's centre the cell of a point may be.
  /// Throws std::invalid_argument if the shape is not one of a grid, the number of cells is not rows * cols, or the
  /// tolerance is not positive.
  SubmapSearch(const plan::GridShape& shape, const std::vector<std::uint8_t>& occupied, double tolerance_m);

  /// Returns the poses at which the points fit, by descending share.
  /// Args: points: in the frame of the submap [m].
  /// Throws std::invalid_argument if a point is farther than 1 km from the others' mean, or a limit is not usable.
  std::vector<Match> Find(const std::vector<base::Point>& points, const Limits& limits) const;

 private:
  class Search;

  /// Whether a point at (row, col) relative to the lower left cell of a block of 2^height x 2^height cells can be on an
  /// occupied cell, for some cell of the block.
  bool MayHit(int height, int row, int col) const;

  plan::GridShape shape_;
  double tolerance_m_;
  int stride_;                                     ///< of a row of a layer
  std::vector<std::vector<std::uint8_t>> layers_;  ///< by height, each with a margin below and to the left
};

}  // namespace robotteamsim::maps
