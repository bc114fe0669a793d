#include "robotteamsim/sensing/laser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace robotteamsim {
namespace {

constexpr double kTurn = 2.0 * 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A beam this near to the end of a segment [beams] meets it, so that rounding lets none through a corner.
constexpr double kSlack = 1e-6;

/// The frame of a laser in the map.
struct Frame {
  Point origin;
  double cos;
  double sin;

  Point ToLocal(const Point& point) const {
    const double dx = point.x - origin.x, dy = point.y - origin.y;
    return {cos * dx + sin * dy, cos * dy - sin * dx};
  }
};

Frame LaserFrame(const Pose& base, double forward) {
  const double cos = std::cos(base.yaw), sin = std::sin(base.yaw);
  return {{base.x + forward * cos, base.y + forward * sin}, cos, sin};
}

void AppendOutline(const Polygon& outline, std::vector<Segment>& segments) {
  for (std::size_t i = 0; i < outline.size(); ++i) segments.push_back({outline[i], outline[(i + 1) % outline.size()]});
}

std::vector<Segment> Outlines(const std::vector<Solid>& solids) {
  std::vector<Segment> segments;
  for (const Solid& solid : solids) AppendOutline(solid.outline, segments);
  return segments;
}

LaserModel Checked(const LaserModel& model) {
  if (model.beams < 1) throw std::invalid_argument("beams must be >= 1, got " + std::to_string(model.beams));
  if (!(model.range_max > model.range_min)) throw std::invalid_argument("range_max must be > range_min");
  if (!(model.range_min >= 0.0)) throw std::invalid_argument("range_min must be >= 0");
  if (!std::isfinite(model.angle_min) || !std::isfinite(model.angle_max) || !std::isfinite(model.forward)) {
    throw std::invalid_argument("angles and position of a laser must be finite");
  }
  return model;
}

}  // namespace

Laser::Laser(const LaserModel& model, const World& world)
    : model_(Checked(model)),
      increment_(model.beams > 1 ? (model.angle_max - model.angle_min) / (model.beams - 1) : 0.0),
      walls_(Outlines(world.solids()), model.range_max) {
  for (int beam = 0; beam < model_.beams; ++beam) {
    const double angle = model_.angle_min + beam * increment_;
    directions_.push_back({std::cos(angle), std::sin(angle)});
  }
}

std::vector<double> Laser::Scan(const World& world, int robot) const {
  const Frame frame = LaserFrame(world.poses().at(robot), model_.forward);
  std::vector<double> ranges(directions_.size(), kInfinity);
  const auto meet = [&](const Segment& segment) {
    MeetSegment({frame.ToLocal(segment.a), frame.ToLocal(segment.b)}, ranges);
  };
  for (const Segment& segment : walls_.Near(frame.origin)) meet(segment);
  std::vector<Segment> leaf;
  for (const Door& door : world.doors()) {
    if (door.closed) AppendOutline(door.leaf.outline, leaf);
  }
  for (const Segment& segment : leaf) meet(segment);
  for (std::size_t other = 0; other < world.robots().size(); ++other) {
    if (static_cast<int>(other) == robot) continue;
    const Pose& pose = world.poses()[other];
    MeetDisc(frame.ToLocal({pose.x, pose.y}), world.robots()[other].radius, ranges);
  }
  for (double& range : ranges) {
    if (range > model_.range_max) range = kInfinity;
  }
  return ranges;
}

std::vector<float> Laser::Report(const std::vector<double>& ranges, const std::vector<double>& noise) const {
  if (!noise.empty() && noise.size() != ranges.size())
    throw std::invalid_argument("noise must have one value per beam");
  std::vector<float> report(ranges.size());
  for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
    const double range = noise.empty() ? ranges[beam] : ranges[beam] + noise[beam];
    const double reported = range > model_.range_max   ? model_.no_return
                            : range < model_.range_min ? model_.too_near
                                                       : range;
    report[beam] = static_cast<float>(reported);
  }
  return report;
}

// Whether a segment, in the laser's frame, runs between base_link, which is never in a solid, and the laser.
bool Laser::CrossesMount(const Segment& segment) const {
  const double ay = segment.a.y, by = segment.b.y;
  if ((ay > 0.0) == (by > 0.0)) return false;
  const double x = segment.a.x - ay * (segment.b.x - segment.a.x) / (by - ay);
  return std::min(-model_.forward, 0.0) <= x && x <= std::max(-model_.forward, 0.0);
}

void Laser::MeetSegment(const Segment& segment, std::vector<double>& ranges) const {
  if (CrossesMount(segment)) {
    std::fill(ranges.begin(), ranges.end(), 0.0);
    return;
  }
  const double nearest = DistanceToSegment({0.0, 0.0}, segment);
  if (nearest > model_.range_max) return;
  const double cross = segment.a.x * segment.b.y - segment.a.y * segment.b.x;
  const double dot = segment.a.x * segment.b.x + segment.a.y * segment.b.y;
  const Point& right = cross >= 0.0 ? segment.a : segment.b;
  const double dx = segment.b.x - segment.a.x, dy = segment.b.y - segment.a.y;
  const double farthest = std::max(std::hypot(segment.a.x, segment.a.y), std::hypot(segment.b.x, segment.b.y));
  ForBeamsBetween(std::atan2(right.y, right.x), std::atan2(std::abs(cross), dot), [&](std::size_t beam) {
    const Direction& direction = directions_[beam];
    const double range = cross / (direction.x * dy - direction.y * dx);
    // A beam along the segment has no point of intersection (NaN, or one far off): it meets the nearest end.
    const double met = range >= nearest ? std::min(range, farthest) : nearest;
    ranges[beam] = std::min(ranges[beam], met);
  });
}

void Laser::MeetDisc(const Point& center, double radius, std::vector<double>& ranges) const {
  const double distance2 = center.x * center.x + center.y * center.y;
  const double reach = model_.range_max + radius;
  if (distance2 > reach * reach) return;
  if (distance2 <= radius * radius) {
    std::fill(ranges.begin(), ranges.end(), 0.0);
    return;
  }
  const double half_width = std::asin(radius / std::sqrt(distance2));
  ForBeamsBetween(std::atan2(center.y, center.x) - half_width, 2.0 * half_width, [&](std::size_t beam) {
    const Direction& direction = directions_[beam];
    const double along = center.x * direction.x + center.y * direction.y;
    const double half_chord2 = radius * radius - (distance2 - along * along);
    if (half_chord2 >= 0.0) ranges[beam] = std::min(ranges[beam], along - std::sqrt(half_chord2));
  });
}

// Calls meet(beam) for every beam whose angle lies in [from, from + width], whole turns apart included.
template <typename Meet>
void Laser::ForBeamsBetween(double from, double width, const Meet& meet) const {
  const double low = std::min(model_.angle_min, model_.angle_max), high = std::max(model_.angle_min, model_.angle_max);
  const double slack = increment_ == 0.0 ? kSlack : kSlack * std::abs(increment_);
  from -= slack;
  width += 2.0 * slack;
  for (double turn = std::ceil((low - from - width) / kTurn); from + turn * kTurn <= high; turn += 1.0) {
    const double start = from + turn * kTurn;
    if (increment_ == 0.0) {
      for (std::size_t beam = 0; beam < directions_.size(); ++beam) meet(beam);
      continue;
    }
    double first = (start - model_.angle_min) / increment_, last = (start + width - model_.angle_min) / increment_;
    if (increment_ < 0.0) std::swap(first, last);
    const int first_beam = std::max(static_cast<int>(std::ceil(first)), 0);
    const int last_beam = std::min(static_cast<int>(std::floor(last)), model_.beams - 1);
    for (int beam = first_beam; beam <= last_beam; ++beam) meet(static_cast<std::size_t>(beam));
  }
}

}  // namespace robotteamsim
