#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::plan {

/// Where the cells of a grid lie in the map frame [m]; row 0 has the lowest y, cells are stored row by row.
struct GridShape {
  base::Point origin;  ///< lower left corner of the lower left cell
  double resolution_m = 0.1;
  int rows = 0;
  int cols = 0;
};

/// Throws std::invalid_argument unless a shape has cells of a usable size, as many as `num_cells`.
void CheckShape(const GridShape& shape, std::size_t num_cells);

/// A row of cells: from `reach` columns before another cell to as many behind it.
struct StampRow {
  int d_row;
  int reach;
};

/// Returns the cells whose centre is nearer than `inflation_m` to the square of cell (0, 0).
std::vector<StampRow> InflationStamp(double inflation_m, const GridShape& shape);

}  // namespace robotteamsim::plan
