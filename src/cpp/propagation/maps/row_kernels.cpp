#include "robotteamsim/propagation/maps/row_kernels.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace robotteamsim::propagation {
namespace {

/// The middles of this many blocks and rows are faded together, so that cells need not wait for them.
constexpr int kBlocksAtOnce = 16;
constexpr int kRowsAtOnce = 8;

/// Returns the FadingCurve at a square of the distance, without walls.
ROBOTTEAMSIM_INLINE float Faded(const FadingCurve& curve, float square) {
  std::int32_t bits = 0;
  std::memcpy(&bits, &square, sizeof bits);
  constexpr std::int32_t kBitsOfOne = 0x3f800000;
  constexpr std::int32_t kFraction = 0x007fffff;
  const std::int32_t mantissa_bits = (bits & kFraction) | kBitsOfOne;
  float mantissa = 0.0F;
  std::memcpy(&mantissa, &mantissa_bits, sizeof mantissa);
  const auto exponent = static_cast<float>((bits - kBitsOfOne) >> 23);
  // Pairs of terms, then pairs of pairs: the dependency chain is half as long as Horner's.
  const auto& c = curve.near;
  const float f = mantissa - 1.0F;
  const float f2 = f * f;
  const float high = (c[7] * f + c[6]) * f2 + (c[5] * f + c[4]);
  const float low = (c[3] * f + c[2]) * f2 + (c[1] * f + c[0]);
  // The constant is added last, so that small terms keep their precision.
  return ((high * (f2 * f2) + low) - curve.per_octave * exponent) + curve.constant;
}

/// The loops of one FadeRows. kHighest: as `highest` there.
template <bool kHighest, typename Weight>
struct Loops {
  static ROBOTTEAMSIM_INLINE Weight Take(Weight* weight, Weight* change) {
    *weight = static_cast<Weight>(*weight + *change);
    *change = 0;
    return *weight;
  }

  static ROBOTTEAMSIM_INLINE void Put(const FadingCurve& curve, float faded, Weight weight, float* value) {
    const float level = faded - curve.per_unit * static_cast<float>(weight);
    *value = kHighest && !(level > *value) ? *value : level;
  }

  static ROBOTTEAMSIM_INLINE void Near(const FadingCurve& curve, const float* __restrict square, float square_along_y,
                                       Weight* __restrict weights, Weight* __restrict changes, float* __restrict values,
                                       int count) {
    for (int i = 0; i < count; ++i) {
      const float sum = square[i] + square_along_y;
      const float faded = Faded(curve, sum < curve.min_square ? curve.min_square : sum);
      Put(curve, faded, Take(weights + i, changes + i), values + i);
    }
  }

  /// Fades whole blocks, or with blocks = 1 a part of one.
  static ROBOTTEAMSIM_INLINE void Far(const FadingCurve& curve, const float* __restrict offset,
                                      const float* __restrict middle, const float* __restrict inverse,
                                      Weight* __restrict weights, Weight* __restrict changes, float* __restrict values,
                                      int blocks, int count) {
    const auto& c = curve.series;
    for (int block = 0; block < blocks; ++block) {
      for (int k = 0; k < count; ++k) {
        const int i = block * kFadingBlock + k;
        const float t = offset[i] * inverse[block];
        const float t2 = t * t;
        const float faded = ((c[4] * t + c[3]) * t2 + (c[2] * t + c[1])) * t2 + (c[0] * t + middle[block]);
        Put(curve, faded, Take(weights + i, changes + i), values + i);
      }
    }
  }

  static ROBOTTEAMSIM_INLINE void Range(const FadingCurve& any_curve, const FadingColumns& columns,
                                        const FadingRange& range, const WeightRows<Weight>& rows, float* values,
                                        std::ptrdiff_t values_stride) {
    const FadingCurve curve = any_curve;  // a local copy, so that stores to `values` cannot alias it
    constexpr int kColumnsAtOnce = kBlocksAtOnce * kFadingBlock;
    float middle[kRowsAtOnce][kBlocksAtOnce];
    float inverse[kRowsAtOnce][kBlocksAtOnce];
    for (int first = 0; first < range.count; first += kRowsAtOnce) {
      const float* const y = range.square_along_y + first;
      const int num_rows = std::min(kRowsAtOnce, range.count - first);
      for (int begin = range.begin; begin < range.end; begin += kColumnsAtOnce) {
        const float* const block_middle = columns.middle + begin / kFadingBlock;
        for (int row = 0; row < num_rows; ++row) {
          for (int i = 0; i < kBlocksAtOnce; ++i) {
            middle[row][i] = Faded(curve, block_middle[i] + y[row]);
            inverse[row][i] = 1.0F / (block_middle[i] + y[row]);
          }
        }
        const std::ptrdiff_t at = begin - range.begin;
        const int count = std::min(kColumnsAtOnce, range.end - begin);
        const int whole = count / kFadingBlock;
        const int rest = whole * kFadingBlock;
        for (int row = 0; row < num_rows; ++row) {
          Weight* const changes = rows.changes + (first + row) * rows.stride + at;
          Weight* const weights = rows.running + at;
          float* const row_values = values + (first + row) * values_stride + at;
          const float* const offset = columns.offset + begin;
          if (y[row] < columns.near_below) {
            Near(curve, columns.square + begin, y[row], weights, changes, row_values, count);
          } else {
            Far(curve, offset, middle[row], inverse[row], weights, changes, row_values, whole, kFadingBlock);
            Far(curve, offset + rest, middle[row] + whole, inverse[row] + whole, weights + rest, changes + rest,
                row_values + rest, 1, count - rest);
          }
        }
      }
    }
  }
};

// A function can be inlined only into one whose target has all of its instructions.
#define ROBOTTEAMSIM_KERNELS(Target, attributes)                                                                     \
  template <typename Weight>                                                                                         \
  attributes void Target##Rows(const FadingCurve& curve, const FadingColumns& columns, const FadingRange& range,     \
                               const WeightRows<Weight>& rows, float* values, std::ptrdiff_t stride, bool highest) { \
    if (highest) {                                                                                                   \
      Loops<true, Weight>::Range(curve, columns, range, rows, values, stride);                                       \
    } else {                                                                                                         \
      Loops<false, Weight>::Range(curve, columns, range, rows, values, stride);                                      \
    }                                                                                                                \
  }

ROBOTTEAMSIM_FOR_EACH_SIMD(ROBOTTEAMSIM_KERNELS)

}  // namespace

template <typename Weight>
FadeRows<Weight> FadeRowsFor(base::Simd simd) {
  return base::SimdVersion<FadeRows<Weight>>(simd, PortableRows<Weight>, Avx2Rows<Weight>, Avx512Rows<Weight>);
}

template FadeRows<std::int16_t> FadeRowsFor(base::Simd);
template FadeRows<std::int32_t> FadeRowsFor(base::Simd);

}  // namespace robotteamsim::propagation
