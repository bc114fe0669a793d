#include "robotteamsim/sensing/range_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::sensing {
namespace {

constexpr double kSharedSight = 0.09;  // 5 degrees

void Check(const RangeLimits& limits) {
  base::CheckNotNegative(limits.range_min_m, "range_min_m");
  base::CheckPositive(limits.range_max_m, "range_max_m");
  if (!(limits.range_max_m > limits.range_min_m)) throw std::invalid_argument("range_max_m must be > range_min_m");
  base::CheckUsableOrInfinite(limits.too_near_m, "too_near_m");
  base::CheckUsableOrInfinite(limits.no_return_m, "no_return_m");
}

void WriteReport(const RangeLimits& limits, const double* __restrict ranges_m, const double* __restrict noise_m,
                 std::size_t count, float* __restrict report) {
  const double least = limits.range_min_m, most = limits.range_max_m, no_return_m = limits.no_return_m,
               near = limits.too_near_m;
  const auto reported = [=](double range) {
    return static_cast<float>(range > most ? no_return_m : range >= least ? range : near);
  };
  if (noise_m == nullptr) {
    for (std::size_t i = 0; i < count; ++i) report[i] = reported(ranges_m[i]);
  } else {
    for (std::size_t i = 0; i < count; ++i) report[i] = reported(ranges_m[i] + noise_m[i]);
  }
}

/// Args: origin, yaw: of the fan, in `map`.  beams: the reported ranges of one robot.
void DimOne(const world::Fan& fan, const base::Point& origin, double yaw, const hazards::Haze& haze, double no_return_m,
            float* beams) {
  if (haze.IsClearAround(origin, fan.range_max_m)) return;
  const double step = fan.beams > 1 ? (fan.angle_max_rad - fan.angle_min_rad) / (fan.beams - 1) : 0.0;
  // Smoke is so smooth that neighbouring beams share the sight along their middle.
  const int shared = std::max(1, step > 0.0 ? base::ClampedInt(kSharedSight / step, 1, fan.beams) : 1);
  for (int first = 0; first < fan.beams; first += shared) {
    const int end = std::min(first + shared, fan.beams);
    const double angle = yaw + fan.angle_min_rad + 0.5 * (first + end - 1) * step;
    const double sight = haze.Sight(origin, {std::cos(angle), std::sin(angle)}, fan.range_max_m);
    if (sight >= fan.range_max_m) continue;
    for (int beam = first; beam < end; ++beam) {
      if (beams[beam] > sight && beams[beam] <= fan.range_max_m) beams[beam] = static_cast<float>(no_return_m);
    }
  }
}

}  // namespace

void Report(const RangeLimits& limits, const base::Table<const double>& ranges_m,
            const base::Table<const double>& noise_m, const base::Table<float>& reported_m) {
  Check(limits);
  if (!noise_m.IsEmpty() && !noise_m.HasShape(ranges_m.rows, ranges_m.cols)) {
    throw std::invalid_argument("noise must have one value per range");
  }
  if (!reported_m.HasShape(ranges_m.rows, ranges_m.cols)) {
    throw std::invalid_argument("reported ranges must have one value per range");
  }
  WriteReport(limits, ranges_m.data, noise_m.IsEmpty() ? nullptr : noise_m.data, ranges_m.rows * ranges_m.cols,
              reported_m.data);
}

void Dim(const world::Fan& fan, const std::vector<base::Pose>& robots, const hazards::Haze& haze, double no_return_m,
         const base::Table<float>& reported_m) {
  base::CheckUsableOrInfinite(no_return_m, "no_return_m");
  if (!reported_m.HasShape(robots.size(), static_cast<std::size_t>(fan.beams))) {
    throw std::invalid_argument("ranges must have one row per robot and one column per beam");
  }
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (std::isnan(robots[i].x)) continue;
    DimOne(fan, fan.Origin(robots[i]), robots[i].yaw, haze, no_return_m, reported_m.Row(i));
  }
}

}  // namespace robotteamsim::sensing
