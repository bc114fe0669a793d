#include "robotteamsim/maps/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace robotteamsim::maps {
namespace {

/// By their numbers in run lengths.
constexpr std::int8_t kValues[] = {kUnknown, kFree, kOccupied};

}  // namespace

OccupancyGrid Cropped(const OccupancyGrid& grid) {
  const plan::GridShape& shape = grid.shape;
  int low_row = shape.rows, low_col = shape.cols, end_row = 0, end_col = 0;
  for (int row = 0; row < shape.rows; ++row) {
    for (int col = 0; col < shape.cols; ++col) {
      if (grid.At(row, col) == kUnknown) continue;
      low_row = std::min(low_row, row);
      low_col = std::min(low_col, col);
      end_row = std::max(end_row, row + 1);
      end_col = std::max(end_col, col + 1);
    }
  }
  if (end_row == 0) return {{shape.origin, shape.resolution_m, 0, 0}, {}};
  OccupancyGrid part{{{shape.origin.x + low_col * shape.resolution_m, shape.origin.y + low_row * shape.resolution_m},
                      shape.resolution_m,
                      end_row - low_row,
                      end_col - low_col},
                     {}};
  part.cells.reserve(static_cast<std::size_t>(part.shape.rows) * part.shape.cols);
  for (int row = low_row; row < end_row; ++row) {
    for (int col = low_col; col < end_col; ++col) part.cells.push_back(grid.At(row, col));
  }
  return part;
}

void Fill(OccupancyGrid* onto, const OccupancyGrid& grid, const base::Pose& pose) {
  const plan::GridShape &to = onto->shape, &from = grid.shape;
  const base::Pose back = base::RelativePose(pose, {});  // the frame of `onto` in that of `grid`
  const double cos = std::cos(back.yaw), sin = std::sin(back.yaw);
  for (int row = 0; row < to.rows; ++row) {
    for (int col = 0; col < to.cols; ++col) {
      std::int8_t& cell = onto->cells[static_cast<std::size_t>(row) * to.cols + col];
      if (cell != kUnknown) continue;
      const double x = to.origin.x + (col + 0.5) * to.resolution_m, y = to.origin.y + (row + 0.5) * to.resolution_m;
      const double from_col = (back.x + cos * x - sin * y - from.origin.x) / from.resolution_m;
      const double from_row = (back.y + sin * x + cos * y - from.origin.y) / from.resolution_m;
      if (from_col < 0.0 || from_col >= from.cols || from_row < 0.0 || from_row >= from.rows) continue;
      cell = grid.At(static_cast<int>(from_row), static_cast<int>(from_col));
    }
  }
}

std::vector<std::uint8_t> RunLengths(const std::vector<std::int8_t>& cells) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
    while (end < cells.size() && cells[end] == cells[begin]) ++end;
    const std::size_t value = cells[begin] == kUnknown ? 0 : cells[begin] == kFree ? 1 : 2;
    std::size_t number = (end - begin) * 4 + value;
    for (; number >= 0x80; number >>= 7) bytes.push_back(static_cast<std::uint8_t>(number | 0x80));
    bytes.push_back(static_cast<std::uint8_t>(number));
  }
  return bytes;
}

std::vector<std::int8_t> CellsOf(const std::vector<std::uint8_t>& run_lengths, std::size_t count) {
  std::vector<std::int8_t> cells;
  cells.reserve(std::min<std::size_t>(count, 1'000'000));
  std::size_t number = 0;
  int shift = 0;
  for (const std::uint8_t byte : run_lengths) {
    if (shift > 28) throw std::invalid_argument("a run of cells is too long");
    number |= static_cast<std::size_t>(byte & 0x7F) << shift;
    shift += 7;
    if ((byte & 0x80) != 0) continue;
    const std::size_t value = number % 4, length = number / 4;
    if (value > 2) throw std::invalid_argument("a run of cells has no such value");
    if (length > count - cells.size()) throw std::invalid_argument("the runs are longer than the grid");
    cells.insert(cells.end(), length, kValues[value]);
    number = 0;
    shift = 0;
  }
  if (shift != 0 || cells.size() != count) throw std::invalid_argument("the runs are shorter than the grid");
  return cells;
}

}  // namespace robotteamsim::maps
