#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::plan {

/// Finds the cells of a grid that can be reached inside a disc, for rows of up to 64 cells at once.
class DiscFill {
 public:
  /// `blocked` has one number per cell, row by row; 0 is free.
  DiscFill(int rows, int cols, const std::vector<std::uint8_t>& blocked);

  /// A disc in units of cells: the middle of cell (row, col) is at (x, y) = (col + 0.5, row + 0.5).
  struct Disc {
    base::Point center;
    double radius;
  };

  /// Cells of one row: bit i stands for column `first_col` + i.
  struct Row {
    int row;
    int first_col;
    std::uint64_t cells;
  };

  /// Sets `reached`, in the order of rows, to the cells that can be reached from a free cell by steps along rows and
  /// columns over free cells whose middles are in the disc. Returns false, with `reached` undefined, if the disc is too
  /// wide or a middle is so near to its rim that rounding would decide.
  bool Reach(const Disc& disc, int start_row, int start_col, std::vector<Row>* reached) const;

 private:
  std::uint64_t FreeCells(int row, int first_col) const;

  int rows_, cols_, words_;
  std::vector<std::uint64_t> free_;  ///< bits, `words_` words of 64 per row; the last word is empty
};

}  // namespace robotteamsim::plan
