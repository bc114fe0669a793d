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

/// Copies rows whose values right of the diagonal are filled in to rows top .. end - 1 of a square matrix, and below
/// its diagonal; on it are zeros.
template <typename Rows, typename Matrix>
void PlaceMirrored(const Rows& rows, Eigen::Index top, Eigen::Index end, Matrix* matrix) {
  for (Eigen::Index row = top; row < end; ++row) {
    const Eigen::Index after = matrix->cols() - row - 1;
    (*matrix)(row, row) = 0;
    matrix->row(row).tail(after) = rows.row(row - top).tail(after);
  }
  for (Eigen::Index row = top + 1; row < matrix->rows(); ++row) {
    for (Eigen::Index col = top; col < std::min(end, row); ++col) (*matrix)(row, col) = rows(col - top, row);
  }
}

}  // namespace robotteamsim
