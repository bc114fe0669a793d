#include "robotteamsim/propagation/cells.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "robotteamsim/propagation/whole_numbers.hpp"

namespace robotteamsim {
namespace {

PointMm RoundedCenter(const GridShape& grid, int row, int col) {
  return RoundToMm(CellCenter(grid, row, col), "centre of a cell");
}

/// Returns the resolution in mm where that is a whole number, else 0.
std::int64_t PitchMm(double resolution_m) {
  const double mm = resolution_m * 1000.0;
  const double whole = std::round(mm);
  return whole >= 1.0 && std::abs(mm - whole) < 1e-6 ? static_cast<std::int64_t>(whole) : 0;
}

}  // namespace

Point CellCenter(const GridShape& grid, int row, int col) {
  return {grid.origin.x + (col + 0.5) * grid.resolution, grid.origin.y + (row + 0.5) * grid.resolution};
}

int CentersMm::FirstFrom(std::int64_t position) const {
  if (pitch == 0) return static_cast<int>(std::lower_bound(at.begin(), at.end(), position) - at.begin());
  const std::int64_t index = -FloorDivide(at.front() - position, pitch);
  return static_cast<int>(std::clamp<std::int64_t>(index, 0, Count()));
}

CellCentersMm::CellCentersMm(const GridShape& grid) {
  if (!(grid.resolution > 0.0)) {
    throw std::invalid_argument("resolution_m must be > 0, got " + std::to_string(grid.resolution));
  }
  if (grid.rows < 1 || grid.cols < 1) {
    throw std::invalid_argument("a grid must hold at least one cell, got " + std::to_string(grid.rows) + " x " +
                                std::to_string(grid.cols));
  }
  const PointMm first = RoundedCenter(grid, 0, 0);
  RoundedCenter(grid, grid.rows - 1, grid.cols - 1);  // throws where the grid reaches beyond the limit
  x.pitch = y.pitch = PitchMm(grid.resolution);
  x.at.resize(grid.cols);
  y.at.resize(grid.rows);
  for (int col = 0; col < grid.cols; ++col) {
    x.at[col] = x.pitch > 0 ? first.x + col * x.pitch : RoundedCenter(grid, 0, col).x;
  }
  for (int row = 0; row < grid.rows; ++row) {
    y.at[row] = y.pitch > 0 ? first.y + row * y.pitch : RoundedCenter(grid, row, 0).y;
  }
}

}  // namespace robotteamsim
