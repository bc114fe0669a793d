#include "robotteamsim/maps/scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

// A range this close to range_max or range_min is not a return: single precision may round it in either direction.
constexpr double kRounding = 1e-6;
// How far before range_max a beam without a return proves free space [m]: noise may have hidden a return behind it.
constexpr double kShortOfRange = 0.1;
// Neighbouring hits are on the same surface if they are nearer to each other than this [m], or than they would be on a
// surface that is so many times as long, seen under a slant, as one that faces the laser.
constexpr double kGap = 0.05, kSlant = 5.0;
// On each side, neighbours are looked for up to this distance [m]: nearer ones make a normal of noise.
constexpr double kBaseline = 0.1;
constexpr int kMostNeighbours = 4;

using Ends = std::vector<std::optional<base::Point>>;

double Distance(const base::Point& a, const base::Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Returns the last hit next to that of a beam, on one side, that is on the same surface. Args: side: -1 or 1.
base::Point Neighbour(const Ends& ends, std::size_t beam, int side, double gap_m) {
  const base::Point& hit = *ends[beam];
  base::Point last = hit;
  for (int i = 1; i <= kMostNeighbours && Distance(last, hit) < kBaseline; ++i) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(beam) + std::ptrdiff_t{side} * i;
    if (at < 0 || at >= static_cast<std::ptrdiff_t>(ends.size()) || !ends[at]) break;
    if (Distance(*ends[at], last) > gap_m) break;
    last = *ends[at];
  }
  return last;
}

/// Returns the normal of the surface that a beam hit, towards the laser; (0, 0) without a neighbour on it.
base::Point NormalAt(const Ends& ends, std::size_t beam, const base::Point& laser, double step_rad) {
  const base::Point& hit = *ends[beam];
  const double gap_m = kGap + kSlant * step_rad * Distance(hit, laser);
  const base::Point before = Neighbour(ends, beam, -1, gap_m), after = Neighbour(ends, beam, 1, gap_m);
  const double dx = after.x - before.x, dy = after.y - before.y, length = std::hypot(dx, dy);
  if (!(length > 0.0)) return {};
  const bool is_towards_laser = dx * (laser.y - hit.y) - dy * (laser.x - hit.x) > 0.0;
  const double sign = is_towards_laser ? 1.0 : -1.0;
  return {-sign * dy / length, sign * dx / length};
}

base::Point Turned(const base::Point& direction, double yaw) {
  const double cos = std::cos(yaw), sin = std::sin(yaw);
  return {cos * direction.x - sin * direction.y, sin * direction.x + cos * direction.y};
}

}  // namespace

base::Point Moved(const base::Point& point, const base::Pose& pose) {
  const base::Point arm = Turned(point, pose.yaw);
  return {pose.x + arm.x, pose.y + arm.y};
}

SurfacePoint Moved(const SurfacePoint& point, const base::Pose& pose) {
  return {Moved(point.at, pose), Turned(point.normal, pose.yaw)};
}

void Check(const ScanLayout& layout) {
  const world::Fan& fan = layout.fan;
  if (layout.most_beams < 1 || fan.beams < 1) throw std::invalid_argument("there must be at least one beam");
  base::CheckNotNegative(layout.range_min_m, "range_min_m");
  base::CheckPositive(fan.range_max_m, "range_max_m");
  for (const double number : {fan.angle_min_rad, fan.angle_max_rad, fan.forward_m, fan.left_m}) {
    base::Check(number, "an angle or the place of the laser");
  }
}

void CheckLengths(const ScanLayout& layout, const std::vector<float>& ranges_m,
                  const std::vector<std::uint8_t>& masked) {
  const auto beams = static_cast<std::size_t>(layout.fan.beams);
  if (ranges_m.size() != beams) throw std::invalid_argument("there must be one range per beam");
  if (!masked.empty() && masked.size() != beams) throw std::invalid_argument("there must be one mask per beam");
}

Scan ReadScan(const ScanLayout& layout, const std::vector<float>& ranges_m, const std::vector<std::uint8_t>& masked) {
  const world::Fan& fan = layout.fan;
  const auto beams = static_cast<std::size_t>(fan.beams);
  CheckLengths(layout, ranges_m, masked);
  const int stride = 1 + (fan.beams - 1) / layout.most_beams;
  const double step_rad = fan.beams > 1 ? (fan.angle_max_rad - fan.angle_min_rad) / (fan.beams - 1) : 0.0;
  const double longest_m = std::min(fan.range_max_m, kLongestBeam);
  const base::Point laser{fan.forward_m, fan.left_m};
  Scan scan{laser, {}, {}};
  Ends ends;
  for (std::size_t beam = 0; beam < beams; beam += static_cast<std::size_t>(stride)) {
    ends.emplace_back();
    const double range_m = ranges_m[beam];
    if (!masked.empty() && masked[beam] != 0) continue;
    if (!(range_m > layout.range_min_m * (1.0 + kRounding))) continue;  // also if it is not a number
    const bool is_hit = range_m < longest_m * (1.0 - kRounding);
    const double length_m = is_hit ? range_m : std::max(longest_m - kShortOfRange, 0.0);
    const double angle = fan.angle_min_rad + static_cast<double>(beam) * step_rad;
    const base::Point end{laser.x + length_m * std::cos(angle), laser.y + length_m * std::sin(angle)};
    if (is_hit) {
      ends.back() = end;
    } else {
      scan.free_ends.push_back(end);
    }
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i]) scan.hits.push_back({*ends[i], NormalAt(ends, i, laser, std::abs(stride * step_rad))});
  }
  return scan;
}

}  // namespace robotteamsim::maps
