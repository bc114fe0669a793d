#include "robotteamsim/propagation/maps/fading.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace robotteamsim::propagation {
namespace {

// Constants instead of calls of log10, whose last bit differs between machines.
constexpr double kLog10Of4096Mm = 0.6123599479677744;  // log10 of 4.096 m, the square root of a unit of squares
constexpr double kHalfLog10Of2 = 0.1505149978319906;   // log10(d) = log2(d^2) * this
constexpr double kHalfLog10OfE = 0.2171472409516259;   // log10(d) = ln(d^2) * this
constexpr double kMmSquareToUnits = 0x1p-24;

/// log2(1 + f) for 0 <= f <= 1, within 3e-7: minimax, by Remez' exchange.
constexpr double kLog2[8] = {2.77289501962e-07, 1.44265626431,  -0.720453033954,  0.472897923476,
                             -0.324253922255,   0.192089537396, -0.0780621281411, 0.0151253591668};

/// ln(1 + t) for |t| <= kSeriesLimit, within 5e-7: minimax, 0 at 0.
constexpr double kLn[5] = {1.00000141, -0.499879653, 0.333073117, -0.259608458, 0.21152389};

FadingCurve CurveOf(const Fading& fading) {
  if (!(fading.min_distance_m > 0.0)) {
    throw std::invalid_argument("min_distance_m must be > 0, got " + std::to_string(fading.min_distance_m));
  }
  FadingCurve curve;
  const double per_octave = fading.slope_db * kHalfLog10Of2;
  for (std::size_t i = 0; i < curve.near.size(); ++i) curve.near[i] = static_cast<float>(-per_octave * kLog2[i]);
  curve.constant = static_cast<float>(fading.constant_db - fading.slope_db * kLog10Of4096Mm);
  for (std::size_t i = 0; i < curve.series.size(); ++i) {
    curve.series[i] = static_cast<float>(-fading.slope_db * kHalfLog10OfE * kLn[i]);
  }
  const double min_mm = fading.min_distance_m * 1000.0;
  curve.per_octave = static_cast<float>(per_octave);
  curve.per_unit = static_cast<float>(fading.unit_db);
  curve.min_square = static_cast<float>(min_mm * min_mm * kMmSquareToUnits);
  return curve;
}

float InUnits(std::int64_t mm_square) { return static_cast<float>(static_cast<double>(mm_square) * kMmSquareToUnits); }

}  // namespace

FadingRows::FadingRows(const Fading& fading, PointMm source, const CellCentersMm& cells) : curve_(CurveOf(fading)) {
  square_along_y_.reserve(cells.y.at.size());
  for (const std::int64_t y : cells.y.at) square_along_y_.push_back(InUnits((y - source.y) * (y - source.y)));
  const int cols = cells.x.Count();
  const std::size_t blocks = (cols + kFadingBlock - 1) / kFadingBlock;
  middle_.assign(blocks + 16, 1.0F);
  square_.reserve(blocks);
  offset_.reserve(blocks);
  for (int begin = 0; begin < cols; begin += kFadingBlock) {
    const int count = std::min(kFadingBlock, cols - begin);
    std::array<std::int64_t, kFadingBlock> squares{};
    for (int i = 0; i < count; ++i) {
      const std::int64_t dx = cells.x.at[begin + i] - source.x;
      squares[i] = dx * dx;
    }
    const auto [lowest, highest] = std::minmax_element(squares.begin(), squares.begin() + count);
    const std::int64_t middle = *lowest + (*highest - *lowest) / 2;
    Block& square = square_.emplace_back();
    Block& offset = offset_.emplace_back();
    for (int i = 0; i < count; ++i) {
      square.values[i] = InUnits(squares[i]);
      offset.values[i] = InUnits(squares[i] - middle);
    }
    const float half_span = InUnits(*highest - middle);
    const float least = std::max(half_span / kSeriesLimit, curve_.min_square + half_span);
    middle_[begin / kFadingBlock] = InUnits(middle);
    near_below_ = std::max(near_below_, least - InUnits(middle));
  }
}

}  // namespace robotteamsim::propagation
