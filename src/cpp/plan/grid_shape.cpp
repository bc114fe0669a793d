#include "robotteamsim/plan/grid_shape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::plan {

void CheckShape(const GridShape& shape, std::size_t num_cells) {
  base::CheckPositive(shape.resolution_m, "resolution_m");
  base::Check(shape.origin, "the origin of a grid");
  if (shape.rows < 1 || shape.cols < 1) throw std::invalid_argument("a grid needs at least one row and one column");
  if (num_cells != static_cast<std::size_t>(shape.rows) * static_cast<std::size_t>(shape.cols)) {
    throw std::invalid_argument("the number of cells must be rows * cols");
  }
}

std::vector<StampRow> InflationStamp(double inflation_m, const GridShape& shape) {
  std::vector<StampRow> stamp;
  const double farthest = std::ceil(inflation_m / shape.resolution_m) + 1.0;
  const int rows = base::ClampedInt(farthest, 0, shape.rows), cols = base::ClampedInt(farthest, 0, shape.cols);
  for (int d_row = -rows; d_row <= rows; ++d_row) {
    int reach = -1;
    while (reach < cols) {
      const double x = std::max(0.0, reach + 1 - 0.5) * shape.resolution_m;
      const double y = std::max(0.0, std::abs(d_row) - 0.5) * shape.resolution_m;
      // The margin keeps a cell at exactly the inflation free despite rounding.
      if (!(x * x + y * y < inflation_m * inflation_m - 1e-9)) break;
      ++reach;
    }
    if (reach >= 0) stamp.push_back({d_row, reach});
  }
  return stamp;
}

}  // namespace robotteamsim::plan
