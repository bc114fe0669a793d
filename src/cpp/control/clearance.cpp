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
    const double across = hit.y * cos - hit.x * sin;
    const double half_chord_squared = radius * radius - across * across;
    // One branch for all hits that do not count: beside the way, behind, and beyond what another one leaves free.
    const bool counts = (along > 0.0) & (half_chord_squared > 0.0) & (along - radius < free);
    if (!counts) continue;
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
  hits.reserve(ranges.size());
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
  std::vector<Way> ways;
  for (const double heading : headings_) ways.push_back({heading, 0.0});
  const auto cost = [&](const Way& way) {
    const double offset = way.heading - wanted;
    const double side_cost = offset > 0.0 ? kLeftPenalty : 0.0;
    return std::abs(offset) + side_cost + (passing_side_ * offset < 0.0 ? kChangePenalty : 0.0);
  };
  std::stable_sort(ways.begin(), ways.end(), [&](const Way& a, const Way& b) { return cost(a) < cost(b); });
  for (Way& way : ways) {
    way.free = FreeDistanceAmong(hits, way.heading, radius, needed);
    if (way.free < needed) continue;
    passing_side_ = way.heading > wanted ? 1 : -1;
    return way;
  }
  return *std::min_element(ways.begin(), ways.end(), [&](const Way& a, const Way& b) {
    if (a.free != b.free) return a.free > b.free;
    const double offset_a = std::abs(a.heading - wanted), offset_b = std::abs(b.heading - wanted);
    return offset_a != offset_b ? offset_a < offset_b : a.heading < b.heading;
  });
}

}  // namespace robotteamsim
