#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace robotteamsim {

/// Rows of a large matrix that are mirrored together: enough that what is written side by side fills cache lines.
constexpr Eigen::Index kMirroredRows = 32;

/// Copies what lies above the diagonal in rows top .. end - 1 of a square matrix to below it.
template <typename Matrix>
void MirrorRows(Eigen::Index top, Eigen::Index end, Matrix* matrix) {
  for (Eigen::Index row = top + 1; row < matrix->rows(); ++row) {
    for (Eigen::Index col = top; col < std::min(end, row); ++col) (*matrix)(row, col) = (*matrix)(col, row);
  }
}

}  // namespace robotteamsim
