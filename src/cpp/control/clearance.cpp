#include "robotteamsim/control/clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::control {
namespace {

/// Number of beams or hits that are tested together. They are ordered by direction: most blocks contain many relevant
/// ones, or none.
constexpr std::size_t kBlock = 16;

constexpr int kMostBeams = 1'000'000;

/// Within 60 degrees of a hit inside the disc, motion leads towards it.
constexpr double kCosSquaredOf60Degrees = 0.25;

/// Returns whether some hits of a block are ahead, within the width of the disc and nearer than the free distance so
/// far.
ROBOTTEAMSIM_INLINE bool SomeCount(const base::Point* hits, const Direction& direction, double radius, double free) {
  std::int64_t some = 0;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double along = hits[i].x * direction.cos + hits[i].y * direction.sin;
    const double across = hits[i].y * direction.cos - hits[i].x * direction.sin;
    const bool counts = (along > 0.0) & (radius * radius - across * across > 0.0) & (along - radius < free);
    some |= counts ? 1 : 0;
  }
  return some != 0;
}

/// Returns how far the disc can move before one hit; infinity if the hit does not count. It has no branch, so that it
/// can be vectorised.
ROBOTTEAMSIM_INLINE double FreeBefore(const base::Point& hit, const Direction& direction, double radius) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double along = hit.x * direction.cos + hit.y * direction.sin;
  const double across = hit.y * direction.cos - hit.x * direction.sin;
  const double half_chord_squared = radius * radius - across * across;
  const double touch = along - std::sqrt(half_chord_squared > 0.0 ? half_chord_squared : 0.0);
  const bool is_ahead = along * along > kCosSquaredOf60Degrees * (along * along + across * across);
  const double free_inside = is_ahead ? 0.0 : kInfinity;
  const double free = touch >= 0.0 ? touch : free_inside;
  const bool counts = (along > 0.0) & (half_chord_squared > 0.0);
  return counts ? free : kInfinity;  // NOLINT(bugprone-narrowing-conversions): both are double
}

ROBOTTEAMSIM_INLINE double FreeAmong(const base::Point* hits, std::size_t count, const Direction& direction,
                                     double radius, double max_distance) {
  double free = max_distance;
  for (std::size_t first = 0; first < count; first += kBlock) {
    if (count - first < kBlock) {
      for (std::size_t i = first; i < count; ++i) free = std::min(free, FreeBefore(hits[i], direction, radius));
    } else if (SomeCount(hits + first, direction, radius, free)) {
      std::array<double, kBlock> before;
      for (std::size_t i = 0; i < kBlock; ++i) before[i] = FreeBefore(hits[first + i], direction, radius);
      for (const double one : before) free = std::min(free, one);
    }
  }
  return free;
}

using FreeAmongFunction = double (*)(const base::Point*, std::size_t, const Direction&, double, double);

#define ROBOTTEAMSIM_FREE_AMONG(Name, attributes)                                                           \
  attributes double Name##FreeAmong(const base::Point* hits, std::size_t count, const Direction& direction, \
                                    double radius, double max_distance) {                                   \
    return FreeAmong(hits, count, direction, radius, max_distance);                                         \
  }
// Wider registers than those of AVX2 do not make it faster.
ROBOTTEAMSIM_FREE_AMONG(Portable, )
ROBOTTEAMSIM_FREE_AMONG(Avx2, ROBOTTEAMSIM_AVX2)

FreeAmongFunction FreeAmongFor(base::Simd simd) {
  return base::SimdVersion<FreeAmongFunction>(simd, PortableFreeAmong, Avx2FreeAmong, Avx2FreeAmong);
}

double FreeAmongHits(const std::vector<base::Point>& hits, const Direction& direction, double radius,
                     double max_distance) {
  static const FreeAmongFunction free_among = FreeAmongFor(base::BestSimd());
  return free_among(hits.data(), hits.size(), direction, radius, max_distance);
}

bool SomeAreBelow(const float* ranges, double longest) {
  std::int64_t some = 0;
  for (std::size_t i = 0; i < kBlock; ++i) some |= ranges[i] < longest ? 1 : 0;
  return some != 0;
}

}  // namespace

Direction::Direction(double angle) : heading(angle), cos(std::cos(angle)), sin(std::sin(angle)) {}

double FreeDistanceAmong(const std::vector<base::Point>& hits, const Direction& direction, double radius,
                         double max_distance, base::Simd simd) {
  return FreeAmongFor(simd)(hits.data(), hits.size(), direction, radius, max_distance);
}

ScanClearance::ScanClearance(const LaserLayout& layout) : layout_(layout) {
  if (layout.beams < 1) throw std::invalid_argument("a laser must have at least one beam");
  if (layout.beams > kMostBeams) throw std::invalid_argument("a laser must have at most a million beams");
  base::Check(layout.angle_min, "angle_min");
  base::Check(layout.angle_max, "angle_max");
  base::Check(layout.forward, "forward");
  base::CheckNotNegative(layout.range_max, "range_max");
  const double step = layout.beams > 1 ? (layout.angle_max - layout.angle_min) / (layout.beams - 1) : 0.0;
  for (int beam = 0; beam < layout.beams; ++beam) {
    const double angle = layout.angle_min + beam * step;
    directions_.push_back({std::cos(angle), std::sin(angle)});
  }
}

std::vector<base::Point> ScanClearance::Hits(const Ranges& ranges, double max_distance) const {
  std::vector<base::Point> hits;
  FindHits(ranges, max_distance, &hits);
  return hits;
}

void ScanClearance::FindHits(const Ranges& ranges, double max_distance, std::vector<base::Point>* hits) const {
  if (ranges.size != directions_.size()) throw std::invalid_argument("there must be one range per beam");
  // A range this close to range_max is not a return: float32 may round range_max in either direction.
  const double longest = std::min(layout_.range_max * (1.0 - 1e-6), max_distance + std::abs(layout_.forward) + 1e-3);
  hits->clear();
  hits->reserve(ranges.size);
  for (std::size_t first = 0; first < ranges.size; first += kBlock) {
    if (ranges.size - first >= kBlock && !SomeAreBelow(ranges.data + first, longest)) continue;
    for (std::size_t beam = first; beam < std::min(ranges.size, first + kBlock); ++beam) {
      const double range = ranges.data[beam];
      if (!(range < longest)) continue;
      const base::Point hit{layout_.forward + range * directions_[beam].x, range * directions_[beam].y};
      if (hit.x * hit.x + hit.y * hit.y < max_distance * max_distance) hits->push_back(hit);
    }
  }
}

double ScanClearance::FreeDistance(const Ranges& ranges, double heading, double radius, double max_distance) const {
  return FreeAmongHits(Hits(ranges, max_distance + radius), Direction(heading), radius, max_distance);
}

std::vector<double> ScanClearance::FreeDistances(const Ranges& ranges, const std::vector<Direction>& directions,
                                                 double radius, double max_distance) const {
  const std::vector<base::Point> hits = Hits(ranges, max_distance + radius);
  std::vector<double> free;
  free.reserve(directions.size());
  for (const Direction& direction : directions) free.push_back(FreeAmongHits(hits, direction, radius, max_distance));
  return free;
}

Sidestepper::Sidestepper(ScanClearance clearance, const std::vector<double>& headings,
                         const SidestepParameters& parameters)
    : clearance_(std::move(clearance)), directions_(headings.begin(), headings.end()), parameters_(parameters) {
  if (directions_.empty()) throw std::invalid_argument("headings must not be empty");
}

Sidestepper::FreeHeading Sidestepper::Find(const Ranges& ranges, double wanted, double radius, double needed) {
  clearance_.FindHits(ranges, needed + radius, &hits_);
  const FreeHeading straight{wanted, FreeAmongHits(hits_, Direction(wanted), radius, needed)};
  if (straight.free >= needed || std::abs(wanted) >= parameters_.ahead) {
    passing_side_ = 0;
    return straight;
  }
  const auto cost = [&](const Direction& direction) {
    const double offset = direction.heading - wanted;
    const double side_cost = offset > 0.0 ? parameters_.left_penalty : 0.0;
    return std::abs(offset) + side_cost + (passing_side_ * offset < 0.0 ? parameters_.change_penalty : 0.0);
  };
  std::vector<std::pair<double, const Direction*>> by_cost;
  for (const Direction& direction : directions_) by_cost.emplace_back(cost(direction), &direction);
  std::sort(by_cost.begin(), by_cost.end());
  std::vector<FreeHeading> tried;
  for (const auto& [_, direction] : by_cost) {
    tried.push_back({direction->heading, FreeAmongHits(hits_, *direction, radius, needed)});
    if (tried.back().free < needed) continue;
    passing_side_ = direction->heading > wanted ? 1 : -1;
    return tried.back();
  }
  return *std::min_element(tried.begin(), tried.end(), [&](const FreeHeading& a, const FreeHeading& b) {
    if (a.free != b.free) return a.free > b.free;
    const double offset_a = std::abs(a.heading - wanted), offset_b = std::abs(b.heading - wanted);
    return offset_a != offset_b ? offset_a < offset_b : a.heading < b.heading;
  });
}

}  // namespace robotteamsim::control
