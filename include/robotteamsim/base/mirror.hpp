#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace robotteamsim::base {

/// Prefetches memory that will be written soon; no value depends on it.
inline void PrefetchToWrite([[maybe_unused]] const void* place) {
#if defined(__GNUC__)
  __builtin_prefetch(place, 1);
#endif
}

/// Number of rows of a large matrix that are mirrored together: enough that writes fill whole cache lines.
constexpr Eigen::Index kMirroredRows = 32;

/// Copies the part above the diagonal of rows top .. end - 1 of a square matrix, or to its last row, below the
/// diagonal.
template <typename Matrix>
void MirrorRows(Eigen::Index top, Eigen::Index end, Matrix* matrix) {
  // rows; they are a whole row apart, which processors do not prefetch by themselves
  constexpr Eigen::Index kAhead = 8;
  constexpr Eigen::Index kPerLine = 64 / sizeof(typename Matrix::Scalar);
  const Eigen::Index size = matrix->rows();
  end = std::min(end, size);
  for (Eigen::Index row = top + 1; row < size; ++row) {
    if (row + kAhead < size) {
      for (Eigen::Index col = top; col < end + kPerLine - 1; col += kPerLine) {
        PrefetchToWrite(&(*matrix)(row + kAhead, std::min(col, end - 1)));
      }
    }
    for (Eigen::Index col = top; col < std::min(end, row); ++col) (*matrix)(row, col) = (*matrix)(col, row);
  }
}

}  // namespace robotteamsim::base
