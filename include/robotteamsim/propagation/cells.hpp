#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim {

/// Values of the cells of a grid, one matrix row per row of cells.
using CellValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the centre of a cell [m].
Point CellCenter(const GridShape& grid, int row, int col);

/// The centres of a grid's cells in whole millimetres, ascending.
struct CellCentersMm {
  std::vector<std::int64_t> x;  ///< of each column
  std::vector<std::int64_t> y;  ///< of each row

  /// Throws std::invalid_argument where the grid has no cell or no size, or lies beyond 1000 km.
  explicit CellCentersMm(const GridShape& grid);
};

}  // namespace robotteamsim
