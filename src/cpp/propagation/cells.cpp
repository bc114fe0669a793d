#include "robotteamsim/propagation/cells.hpp"

#include <stdexcept>
#include <string>

#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim {

Point CellCenter(const GridShape& grid, int row, int col) {
  return {grid.origin.x + (col + 0.5) * grid.resolution, grid.origin.y + (row + 0.5) * grid.resolution};
}

CellCentersMm::CellCentersMm(const GridShape& grid) {
  if (!(grid.resolution > 0.0)) {
    throw std::invalid_argument("resolution_m must be > 0, got " + std::to_string(grid.resolution));
  }
  if (grid.rows < 1 || grid.cols < 1) {
    throw std::invalid_argument("a grid must hold at least one cell, got " + std::to_string(grid.rows) + " x " +
                                std::to_string(grid.cols));
  }
  for (int col = 0; col < grid.cols; ++col) x.push_back(RoundToMm(CellCenter(grid, 0, col), "centre of a cell").x);
  for (int row = 0; row < grid.rows; ++row) y.push_back(RoundToMm(CellCenter(grid, row, 0), "centre of a cell").y);
}

}  // namespace robotteamsim
