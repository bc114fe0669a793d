#include "robotteamsim/propagation/cells.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::propagation {
namespace {

PointMm RoundedCenter(const plan::GridShape& grid, int row, int col) {
  return RoundToMm(CellCenter(grid, row, col), "centre of a cell");
}

/// Returns the resolution in mm if it is a whole number, else 0.
std::int64_t PitchMm(double resolution_m) {
  const double mm = resolution_m * 1000.0;
  const double whole = std::round(mm);
  return whole >= 1.0 && std::abs(mm - whole) < 1e-6 ? static_cast<std::int64_t>(whole) : 0;
}

}  // namespace

int CentersMm::FirstFrom(std::int64_t position) const {
  const int last = Count() - 1;
  if (position > at[last]) return Count();
  // A guess that is off by at most one; the centres decide.
  const double guess = static_cast<double>(position - at[0]) * per_mm;
  int index = base::ClampedInt(guess, 0, last);
  while (at[index] < position) ++index;
  while (index > 0 && at[index - 1] >= position) --index;
  return index;
}

CellCentersMm::CellCentersMm(const plan::GridShape& grid) {
  base::CheckPositive(grid.resolution_m, "resolution_m");
  if (grid.rows < 1 || grid.cols < 1) {
    throw std::invalid_argument("a grid must hold at least one cell, got " + std::to_string(grid.rows) + " x " +
                                std::to_string(grid.cols));
  }
  const PointMm first = RoundedCenter(grid, 0, 0);
  RoundedCenter(grid, grid.rows - 1, grid.cols - 1);  // throws if the grid extends beyond the limit
  x.pitch = y.pitch = PitchMm(grid.resolution_m);
  x.per_mm = y.per_mm = 1.0 / (grid.resolution_m * 1000.0);
  x.at.resize(grid.cols);
  y.at.resize(grid.rows);
  for (int col = 0; col < grid.cols; ++col) {
    x.at[col] = x.pitch > 0 ? first.x + col * x.pitch : RoundedCenter(grid, 0, col).x;
  }
  for (int row = 0; row < grid.rows; ++row) {
    y.at[row] = y.pitch > 0 ? first.y + row * y.pitch : RoundedCenter(grid, row, 0).y;
  }
}

}  // namespace robotteamsim::propagation
