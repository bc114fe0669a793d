#include "robotteamsim/control/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace robotteamsim {
namespace {

double FreeDistanceAmong(const std::vector<Point>& hits, double heading, double radius, double max_distance) {
  const double cos = std::cos(heading);
  const double sin = std::sin(heading);
  double free = max_distance;
  for (const Point& hit : hits) {
    const double along = hit.x * cos + hit.y * sin;
    if (along <= 0.0) continue;
    const double across = hit.y * cos - hit.x * sin;
    const double half_chord_squared = radius * radius - across * across;
    if (half_chord_squared <= 0.0) continue;
    const double touch = along - std::sqrt(half_chord_squared);
    if (touch >= 0.0) {
      free = std::min(free, touch);
    } else if (along * along > 0.25 * (along * along + across * across)) {
      return 0.0;
    }
  }
  return free;
}

constexpr double kLeftPenalty = 0.25;
constexpr double kChangePenalty = 0.35;
/// A wanted heading farther than this to the side or behind is turned to on the spot.
constexpr double kAhead = 1.6;

}  // namespace

ScanClearance::ScanClearance(const LaserLayout& layout) : layout_(layout) {
  if (layout.beams < 1) throw std::invalid_argument("a laser needs at least one beam");
  const double step = layout.beams > 1 ? (layout.angle_max - layout.angle_min) / (layout.beams - 1) : 0.0;
  for (int beam = 0; beam < layout.beams; ++beam) {
    const double angle = layout.angle_min + beam * step;
    directions_.push_back({std::cos(angle), std::sin(angle)});
  }
}

std::vector<Point> ScanClearance::Hits(const std::vector<float>& ranges, double max_distance) const {
  if (ranges.size() != directions_.size()) throw std::invalid_argument("there must be one range per beam");
  // A range this close to range_max is no return: float32 may round range_max itself to either side.
  const double longest = std::min(layout_.range_max * (1.0 - 1e-6), max_distance + std::abs(layout_.forward) + 1e-3);
  std::vector<Point> hits;
  for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
    const double range = ranges[beam];
    if (!(range < longest)) continue;
    const Point hit{layout_.forward + range * directions_[beam].x, range * directions_[beam].y};
    if (hit.x * hit.x + hit.y * hit.y < max_distance * max_distance) hits.push_back(hit);
  }
  return hits;
}

double ScanClearance::FreeDistance(const std::vector<float>& ranges, double heading, double radius,
                                   double max_distance) const {
  return FreeDistanceAmong(Hits(ranges, max_distance + radius), heading, radius, max_distance);
}

std::vector<double> ScanClearance::FreeDistances(const std::vector<float>& ranges, const std::vector<double>& headings,
                                                 double radius, double max_distance) const {
  const std::vector<Point> hits = Hits(ranges, max_distance + radius);
  std::vector<double> free;
  for (const double heading : headings) free.push_back(FreeDistanceAmong(hits, heading, radius, max_distance));
  return free;
}

Sidestepper::Sidestepper(ScanClearance clearance, std::vector<double> headings)
    : clearance_(std::move(clearance)), headings_(std::move(headings)) {
  if (headings_.empty()) throw std::invalid_argument("there must be a heading to take");
}

Sidestepper::Way Sidestepper::Find(const std::vector<float>& ranges, double wanted, double radius, double needed) {
  const std::vector<Point> hits = clearance_.Hits(ranges, needed + radius);
  const Way straight{wanted, FreeDistanceAmong(hits, wanted, radius, needed)};
  if (straight.free >= needed || std::abs(wanted) >= kAhead) {
    passing_side_ = 0;
    return straight;
  }
  Way free_way{0.0, -1.0}, farthest{0.0, -1.0};
  double least_cost = std::numeric_limits<double>::infinity();
  for (const double heading : headings_) {
    const Way way{heading, FreeDistanceAmong(hits, heading, radius, needed)};
    const double offset = heading - wanted;
    if (way.free > farthest.free ||
        (way.free == farthest.free && std::abs(offset) < std::abs(farthest.heading - wanted))) {
      farthest = way;
    }
    double cost = std::abs(offset) + (offset > 0.0 ? kLeftPenalty : 0.0);
    if (passing_side_ * offset < 0.0) cost += kChangePenalty;
    if (way.free >= needed && cost < least_cost) {
      free_way = way;
      least_cost = cost;
    }
  }
  if (free_way.free < 0.0) return farthest;
  passing_side_ = free_way.heading > wanted ? 1 : -1;
  return free_way;
}

}  // namespace robotteamsim
