#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "robotteamsim/base/simd.hpp"

namespace robotteamsim::propagation {

/// Number of cells of a block; blocks start at the first cell of a row.
constexpr int kFadingBlock = 32;

/// The series of FadingRows is valid if the squares in a block differ by less than this fraction of the block's middle.
constexpr float kSeriesLimit = 0.2F;

/// The fading of a signal with the square of the distance s = (1 + f) 2^e, 0 <= f < 1, in units of 2^24 mm^2 = (4.096
/// m)^2: value = constant + near[0] + near[1] f + ... + near[7] f^7 - per_octave * e - per_unit * weight of the walls.
struct FadingCurve {
  std::array<float, 8> near{};
  std::array<float, 5> series{};  ///< factors of (n/s), ..., (n/s)^5 in the difference from s to s + n
  float constant = 0.0F;
  float per_octave = 0.0F;
  float per_unit = 0.0F;
  float min_square = 0.0F;  ///< lower limit of squares
};

/// The columns of a map relative to one source.
struct FadingColumns {
  const float* square = nullptr;  ///< per column: square of the distance along x
  const float* offset = nullptr;  ///< per column: its square less the middle of those of its block
  const float* middle = nullptr;  ///< per block: that middle, and 16 more values
  float near_below = 0.0F;        ///< least square along y from which the series is valid in all blocks
};

/// Rows of a map: `count` of them, in columns [begin, end), begin a multiple of kFadingBlock.
struct FadingRange {
  const float* square_along_y = nullptr;  ///< of each row
  int count = 0;
  int begin = 0;
  int end = 0;
};

/// Weights of rows, as changes from the row below, `stride` numbers apart. They are added to one running row, at first
/// the weights of the row below, and zeroed.
template <typename Weight>
struct WeightRows {
  Weight* changes = nullptr;
  std::ptrdiff_t stride = 0;
  Weight* running = nullptr;
};

/// Writes the values of a range. Weights and values begin at its first row and column; rows of values are
/// `values_stride` numbers apart. `highest`: only values above the existing ones are written.
template <typename Weight>
using FadeRows = void (*)(const FadingCurve& curve, const FadingColumns& columns, const FadingRange& range,
                          const WeightRows<Weight>& rows, float* values, std::ptrdiff_t values_stride, bool highest);

/// Returns the loop over rows for one instruction set. Weight: std::int16_t or std::int32_t.
/// Throws std::invalid_argument if this machine does not support the instruction set.
template <typename Weight>
FadeRows<Weight> FadeRowsFor(base::Simd simd);

}  // namespace robotteamsim::propagation
