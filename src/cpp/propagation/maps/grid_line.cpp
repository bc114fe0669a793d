#include "robotteamsim/propagation/maps/grid_line.hpp"

#include <algorithm>
#include <cmath>

namespace robotteamsim::propagation {
namespace {

std::int64_t FloorDivide(std::int64_t numerator, std::int64_t positive) {
  return numerator / positive - (numerator % positive < 0 ? 1 : 0);
}

}  // namespace

int FirstBeyond(const GridLine& line, std::int64_t place_along, const CentersMm& across) {
  const std::int64_t rise = (place_along - line.along) * line.d_across - (line.centers_on_it_are_beyond ? 1 : 0);
  return across.FirstFrom(line.across + FloorDivide(rise, line.d_along) + 1);
}

std::optional<SteppedLine> StepsOf(const GridLine& line, const CentersMm& along, const CentersMm& across, int first,
                                   int count) {
  if (along.pitch == 0) return std::nullopt;
  // The index is floor((n + 1/2) / c) + 1 for whole numbers n and c: (n + 1/2) / c is never nearer to a whole number
  // than 1 / 2c. The integer part is right if the errors of position and steps are below that.
  const std::int64_t n = (line.across - across.at.front()) * line.d_along +
                         (along.at[first] - line.along) * line.d_across - (line.centers_on_it_are_beyond ? 1 : 0);
  const double c = static_cast<double>(line.d_along) * static_cast<double>(along.pitch);
  const double position = (static_cast<double>(n) + 0.5) / c + 1.0;
  const double step = static_cast<double>(line.d_across) / static_cast<double>(line.d_along);
  const double farthest = std::abs(position) + count * std::abs(step);
  constexpr double kOne = static_cast<double>(std::int64_t{1} << SteppedLine::kFractionBits);
  // Two units per number for rounding to fixed point, plus the rounding of the doubles.
  const double error = (count + 1) * (2.0 + farthest * kOne * 0x1p-51);
  if (std::abs(static_cast<double>(n)) > 0x1p51 || farthest > 0x1p20 || 2.0 * c * error > 0.99 * kOne) {
    return std::nullopt;
  }
  const auto fixed_step = static_cast<std::int64_t>(step * kOne);
  return SteppedLine{static_cast<std::int64_t>(position * kOne), fixed_step == 0 ? 1 : fixed_step};
}

IndexRange InsideGrid(const GridLine& line, const CentersMm& along, const CentersMm& across, IndexRange range) {
  // The places one pitch (at least 1 mm) below the first centre across and above the last.
  const double margin = static_cast<double>(across.pitch) + 1.0;
  const double below = static_cast<double>(across.at.front() - line.across) - margin;
  const double above = static_cast<double>(across.at.back() - line.across) + margin;
  if (line.d_across == 0) return below <= 0.0 && above >= 0.0 ? range : IndexRange{range.first, range.first};
  const double slope = static_cast<double>(line.d_along) / static_cast<double>(line.d_across);
  const auto index = [&](double from_point) {
    constexpr double kFar = 4.0 * static_cast<double>(kMaxCoordinateMm);
    const auto place = static_cast<std::int64_t>(std::floor(std::clamp(from_point, -kFar, kFar)));
    return along.FirstFrom(line.along + place);
  };
  // 2 mm for rounding, not one index: on a grid finer than 1 mm several centres coincide.
  const int first = std::max(range.first, index(std::min(below * slope, above * slope) - 2.0));
  const int last = std::min(range.last, index(std::max(below * slope, above * slope) + 2.0));
  return {first, std::max(first, last)};
}

}  // namespace robotteamsim::propagation
