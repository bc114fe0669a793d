#include "robotteamsim/control/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::control {
namespace {

constexpr int kMostBeams = 1'000'000;

/// Within 60 degrees of a hit inside the disc, motion leads towards it.
constexpr double kCosSquaredOf60Degrees = 0.25;

/// Returns how far a disc of `radius_m` can move from (0, 0) in a direction before it touches a hit, at most
/// `max_distance_m`. A hit inside the disc counts only if the motion leads towards it, so that a robot can always slide
/// along a wall or leave it.
double FreeAmong(const std::vector<base::Point>& hits, const Direction& direction, double radius_m,
                 double max_distance_m) {
  double free = max_distance_m;
  for (const base::Point& hit : hits) {
    const double along = hit.x * direction.cos + hit.y * direction.sin;
    const double across = hit.y * direction.cos - hit.x * direction.sin;
    const double half_chord_squared = radius_m * radius_m - across * across;
    if (!(along > 0.0) || !(half_chord_squared > 0.0) || along - radius_m >= free) continue;
    const double touch = along - std::sqrt(half_chord_squared);
    if (touch >= 0.0) {
      free = std::min(free, touch);
    } else if (along * along > kCosSquaredOf60Degrees * (along * along + across * across)) {
      free = std::min(free, 0.0);
    }
  }
  return free;
}

}  // namespace

Direction::Direction(double angle_rad) : heading_rad(angle_rad), cos(std::cos(angle_rad)), sin(std::sin(angle_rad)) {}

ScanClearance::ScanClearance(const LaserLayout& layout) : layout_(layout) {
  if (layout.beams < 1) throw std::invalid_argument("a laser must have at least one beam");
  if (layout.beams > kMostBeams) throw std::invalid_argument("a laser must have at most a million beams");
  base::Check(layout.angle_min_rad, "angle_min_rad");
  base::Check(layout.angle_max_rad, "angle_max_rad");
  base::Check(layout.forward_m, "forward_m");
  base::Check(layout.left_m, "left_m");
  base::CheckNotNegative(layout.range_max_m, "range_max_m");
  const double step = layout.beams > 1 ? (layout.angle_max_rad - layout.angle_min_rad) / (layout.beams - 1) : 0.0;
  for (int beam = 0; beam < layout.beams; ++beam) {
    const double angle = layout.angle_min_rad + beam * step;
    directions_.push_back({std::cos(angle), std::sin(angle)});
  }
}

std::vector<base::Point> ScanClearance::Hits(const Ranges& ranges, double max_distance_m) const {
  std::vector<base::Point> hits;
  FindHits(ranges, max_distance_m, &hits);
  return hits;
}

void ScanClearance::FindHits(const Ranges& ranges, double max_distance_m, std::vector<base::Point>* hits) const {
  if (ranges.size != directions_.size()) throw std::invalid_argument("there must be one range per beam");
  // A range this close to range_max_m is not a return: float32 may round range_max_m in either direction.
  const double aside_m = std::abs(layout_.forward_m) + std::abs(layout_.left_m);
  const double longest = std::min(layout_.range_max_m * (1.0 - 1e-6), max_distance_m + aside_m + 1e-3);
  hits->clear();
  hits->reserve(ranges.size);
  for (std::size_t beam = 0; beam < ranges.size; ++beam) {
    const double range = ranges.data[beam];
    if (!(range < longest)) continue;
    const base::Point hit{layout_.forward_m + range * directions_[beam].x,
                          layout_.left_m + range * directions_[beam].y};
    if (hit.x * hit.x + hit.y * hit.y < max_distance_m * max_distance_m) hits->push_back(hit);
  }
}

double ScanClearance::FreeDistance(const Ranges& ranges, double heading_rad, double radius_m,
                                   double max_distance_m) const {
  return FreeAmong(Hits(ranges, max_distance_m + radius_m), Direction(heading_rad), radius_m, max_distance_m);
}

std::vector<double> ScanClearance::FreeDistances(const Ranges& ranges, const std::vector<Direction>& directions,
                                                 double radius_m, double max_distance_m) const {
  const std::vector<base::Point> hits = Hits(ranges, max_distance_m + radius_m);
  std::vector<double> free;
  free.reserve(directions.size());
  for (const Direction& direction : directions) free.push_back(FreeAmong(hits, direction, radius_m, max_distance_m));
  return free;
}

Sidestepper::Sidestepper(ScanClearance clearance, const std::vector<double>& headings_rad,
                         const SidestepParameters& parameters)
    : clearance_(std::move(clearance)), directions_(headings_rad.begin(), headings_rad.end()), parameters_(parameters) {
  if (directions_.empty()) throw std::invalid_argument("headings must not be empty");
}

Sidestepper::FreeHeading Sidestepper::Find(const Ranges& ranges, double wanted_rad, double radius_m, double needed_m) {
  clearance_.FindHits(ranges, needed_m + radius_m, &hits_);
  const FreeHeading straight{wanted_rad, FreeAmong(hits_, Direction(wanted_rad), radius_m, needed_m)};
  if (straight.free_m >= needed_m || std::abs(wanted_rad) >= parameters_.ahead_rad) {
    passing_side_ = 0;
    return straight;
  }
  const auto cost = [&](const Direction& direction) {
    const double offset = direction.heading_rad - wanted_rad;
    const double side_cost = offset > 0.0 ? parameters_.left_penalty : 0.0;
    return std::abs(offset) + side_cost + (passing_side_ * offset < 0.0 ? parameters_.change_penalty : 0.0);
  };
  std::vector<std::pair<double, const Direction*>> by_cost;
  for (const Direction& direction : directions_) by_cost.emplace_back(cost(direction), &direction);
  std::sort(by_cost.begin(), by_cost.end());
  std::vector<FreeHeading> tried;
  for (const auto& [_, direction] : by_cost) {
    tried.push_back({direction->heading_rad, FreeAmong(hits_, *direction, radius_m, needed_m)});
    if (tried.back().free_m < needed_m) continue;
    passing_side_ = direction->heading_rad > wanted_rad ? 1 : -1;
    return tried.back();
  }
  return *std::min_element(tried.begin(), tried.end(), [&](const FreeHeading& a, const FreeHeading& b) {
    if (a.free_m != b.free_m) return a.free_m > b.free_m;
    const double offset_a = std::abs(a.heading_rad - wanted_rad), offset_b = std::abs(b.heading_rad - wanted_rad);
    return offset_a != offset_b ? offset_a < offset_b : a.heading_rad < b.heading_rad;
  });
}

}  // namespace robotteamsim::control
