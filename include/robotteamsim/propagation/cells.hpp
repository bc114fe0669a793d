#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "robotteamsim/plan/grid.hpp"
#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim::propagation {

/// Values of the cells of a grid, one matrix row per row of cells.
using CellValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Values of a map of the floor, one matrix row per row of cells.
using MapValues = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the centre of a cell [m].
inline base::Point CellCenter(const plan::GridShape& grid, int row, int col) {
  return {grid.origin.x + (col + 0.5) * grid.resolution_m, grid.origin.y + (row + 0.5) * grid.resolution_m};
}

/// Indices from first to last - 1.
struct IndexRange {
  int first = 0;
  int last = 0;
};

/// The centres of a grid's cells along one axis [mm], ascending.
struct CentersMm {
  std::vector<std::int64_t> at;
  std::int64_t pitch = 0;  ///< distance of neighbours; 0 if it varies
  double per_mm = 0.0;     ///< 1 / mean pitch

  int Count() const { return static_cast<int>(at.size()); }

  /// Returns the first index whose centre is >= position; Count() if there is none.
  int FirstFrom(std::int64_t position) const;
};

/// The centres of a grid's cells in whole millimetres. If the resolution is a whole number of millimetres, so is the
/// pitch: only the first centre is rounded. Else each centre is rounded.
struct CellCentersMm {
  CentersMm x;  ///< of the columns
  CentersMm y;  ///< of the rows

  /// Throws std::invalid_argument if the grid has no cell or no size, or lies beyond 1000 km.
  explicit CellCentersMm(const plan::GridShape& grid);

  PointMm At(int row, int col) const { return {x.at[col], y.at[row]}; }
};

}  // namespace robotteamsim::propagation
