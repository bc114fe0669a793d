#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/maps/row_kernels.hpp"

namespace robotteamsim::propagation {

/// The fading of a signal: value = constant_db - slope_db * log10(distance in m) - unit_db * weight of the walls.
struct Fading {
  double constant_db = 0.0;
  double slope_db = 0.0;
  double unit_db = 0.0;
  double min_distance_m = 0.0;  ///< lower limit of distances
};

/// Computes rows of values from rows of weights, for one source.
///
/// Far from the source, squares of distances in one block of cells differ little: log(s + n) = log(s) + log(1 + n/s)
/// takes one logarithm and one division per block and a short series per cell; n does not depend on the row. Near the
/// source, each cell has its own logarithm, a polynomial in the fraction of a float. Values are the same to the bit on
/// every machine.
class FadingRows {
 public:
  /// Throws std::invalid_argument if min_distance_m is not above 0.
  FadingRows(const Fading& fading, PointMm source, const CellCentersMm& cells);

  /// Writes the values of rows [first, first + count) in columns [begin, end), as FadeRows does; begin is a multiple of
  /// kFadingBlock.
  template <typename Weight>
  void Write(FadeRows<Weight> fade, IndexRange rows, IndexRange cols, const WeightRows<Weight>& weights, float* values,
             std::ptrdiff_t values_stride, bool highest) const {
    const FadingColumns columns{square_.front().values.data(), offset_.front().values.data(), middle_.data(),
                                near_below_};
    const FadingRange range{square_along_y_.data() + rows.first, rows.last - rows.first, cols.first, cols.last};
    fade(curve_, columns, range, weights, values, values_stride, highest);
  }

 private:
  /// One value per column of a block, aligned to cache lines.
  struct alignas(64) Block {
    std::array<float, kFadingBlock> values{};
  };

  FadingCurve curve_;
  std::vector<float> square_along_y_;  // per row; the others as in FadingColumns
  std::vector<Block> square_;
  std::vector<Block> offset_;
  std::vector<float> middle_;
  float near_below_ = 0.0F;
};

}  // namespace robotteamsim::propagation
