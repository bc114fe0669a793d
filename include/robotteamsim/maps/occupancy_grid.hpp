#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::maps {

/// What is known of a cell, in the numbers of ROS (nav_msgs/OccupancyGrid).
constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;

constexpr double kMostCells = 1e8;  ///< of a grid

/// What is known of the cells of a grid, row by row.
struct OccupancyGrid {
  plan::GridShape shape;
  std::vector<std::int8_t> cells;

  std::int8_t At(int row, int col) const { return cells[static_cast<std::size_t>(row) * shape.cols + col]; }
};

/// Returns the smallest part of a grid with everything known; no cells if nothing is known.
OccupancyGrid Cropped(const OccupancyGrid& grid);

/// Writes what a grid at some pose knows into the cells of another grid that are unknown, as far as this one reaches.
/// Args: pose: of the frame of `grid`, in that of `onto`.
void Fill(OccupancyGrid* onto, const OccupancyGrid& grid, const base::Pose& pose);

/// Returns the run lengths of cells: for each run its length times 4 plus 0 for unknown, 1 for free and 2 for occupied
/// cells, as an LEB128 number.
std::vector<std::uint8_t> RunLengths(const std::vector<std::int8_t>& cells);

/// Returns the cells of run lengths. Throws std::invalid_argument unless these are `count` cells.
std::vector<std::int8_t> CellsOf(const std::vector<std::uint8_t>& run_lengths, std::size_t count);

}  // namespace robotteamsim::maps
