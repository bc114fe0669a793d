#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::maps {

/// How far each cell of a grid is from the nearest occupied one, and how far a beam reaches in the grid.
///
/// Exact Euclidean distances between centres of cells [felzenszwalb2012].
class DistanceField {
 public:
  /// Args: occupied: nonzero in occupied cells, row by row.
  /// Throws std::invalid_argument if the shape is not one of a grid, or the number of cells is not rows * cols.
  DistanceField(const plan::GridShape& shape, const std::vector<std::uint8_t>& occupied);

  const plan::GridShape& shape() const { return shape_; }
  /// The distances of all cells, row by row; infinity if no cell is occupied [m].
  std::vector<float> distances_m() const;

  /// Returns how far a beam reaches: to the border of the first occupied cell on its way, 0 if it begins in one;
  /// infinity if that is farther than `range_max_m`, or if the beam leaves the grid before [m].
  /// Args: direction: of length 1.
  double Trace(const base::Point& origin, const base::Point& direction, double range_max_m) const;

 private:
  plan::GridShape shape_;
  std::vector<float> cells_;  ///< distances in cells
};

}  // namespace robotteamsim::maps
