#include "robotteamsim/world/fan_caster.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::world {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostBeams = 1'000'000;

Fan Checked(const Fan& fan) {
  if (fan.beams < 1) throw std::invalid_argument("beams must be >= 1, got " + std::to_string(fan.beams));
  if (fan.beams > kMostBeams) throw std::invalid_argument("beams must be at most a million");
  for (const double value : {fan.angle_min_rad, fan.angle_max_rad, fan.forward_m, fan.left_m}) {
    if (!base::IsUsable(value)) throw std::invalid_argument("angles and position of a fan must be finite");
  }
  base::CheckPositive(fan.range_max_m, "range_max_m");
  return fan;
}

}  // namespace

class FanCaster::View {
 public:
  View(const Fan& fan, const SortedBeams& beams, const base::Pose& base)
      : beams_(beams),
        range_max2_(fan.range_max_m * fan.range_max_m),
        cos_(std::cos(base.yaw + beams.Zero())),
        sin_(std::sin(base.yaw + beams.Zero())),
        origin_(fan.Origin(base)),
        base_(ToLocal({base.x, base.y})),
        is_mounted_apart_(fan.forward_m != 0.0 || fan.left_m != 0.0),
        ranges_m_(beams.Count(), kInfinity) {}

  const base::Point& origin() const { return origin_; }

  void MeetEdge(const base::Segment& edge) {
    const base::Point a = ToLocal(edge.a), b = ToLocal(edge.b);
    const double cross = Cross(a, b);
    if (cross >= 0.0) {  // the fan is behind the edge, inside the solid, or on its line
      if (is_mounted_apart_ && CrossesMount(a, b)) is_inside_ = true;
      return;
    }
    if (beams_.IsHalf() && a.y < -kBehind && b.y < -kBehind) return;
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double a2 = a.x * a.x + a.y * a.y, b2 = b.x * b.x + b.y * b.y, length2 = dx * dx + dy * dy;
    const double along =
        -(a.x * dx + a.y * dy);  // of the foot of the perpendicular, in units of the edge times length2
    const double nearest2 = along <= 0.0 ? a2 : along >= length2 ? b2 : cross * cross / length2;
    if (nearest2 > range_max2_) return;
    const double nearest = std::sqrt(nearest2), farthest = std::sqrt(std::max(a2, b2));
    const double* const x = beams_.X();
    const double* const y = beams_.Y();
    double* const ranges_m = ranges_m_.data();
    beams_.ForBeamsBetween(PseudoAngle(b.x, b.y), PseudoAngle(a.x, a.y), [&](int first, int end) {
      for (int i = first; i < end; ++i) {
        const double range = cross / (x[i] * dy - y[i] * dx);
        // A beam almost parallel to the edge may intersect its line far away: use the nearest end.
        const double met = range >= nearest ? std::min(range, farthest) : nearest;
        ranges_m[i] = std::min(ranges_m[i], met);
      }
    });
  }

  void MeetDisc(const base::Pose& disc, double radius_m, double range_max_m) {
    const base::Point center = ToLocal({disc.x, disc.y});
    const double distance2 = center.x * center.x + center.y * center.y;
    const double reach_m = range_max_m + radius_m, radius2 = radius_m * radius_m;
    if (distance2 > reach_m * reach_m) return;
    if (distance2 <= radius2) {
      is_inside_ = true;
      return;
    }
    if (beams_.IsHalf() && center.y < -radius_m - kBehind) return;
    const double tangent = std::sqrt(distance2 - radius2);
    const double right =
        PseudoAngle(center.x * tangent + center.y * radius_m, center.y * tangent - center.x * radius_m);
    const double left = PseudoAngle(center.x * tangent - center.y * radius_m, center.y * tangent + center.x * radius_m);
    const double* const x = beams_.X();
    const double* const y = beams_.Y();
    double* const ranges_m = ranges_m_.data();
    beams_.ForBeamsBetween(right, left, [&](int first, int end) {
      for (int i = first; i < end; ++i) {
        const double along = center.x * x[i] + center.y * y[i];
        const double half_chord2 = radius2 - (distance2 - along * along);
        const double met = half_chord2 >= 0.0 ? along - std::sqrt(std::max(half_chord2, 0.0)) : kInfinity;
        ranges_m[i] = std::min(ranges_m[i], met);
      }
    });
  }

  /// Args: corners: of a polygon in the frame of its pose; empty: a disc. reach: radius of the body.
  void MeetBody(const Polygon& corners, const base::Pose& pose, double reach_m, double range_max_m) {
    if (corners.empty()) {
      MeetDisc(pose, reach_m, range_max_m);
    } else {
      MeetPolygon(corners, pose, reach_m, range_max_m);
    }
  }

  void MeetPolygon(const Polygon& corners, const base::Pose& pose, double reach_m, double range_max_m) {
    const base::Point center = ToLocal({pose.x, pose.y});
    const double farthest = range_max_m + reach_m;
    if (center.x * center.x + center.y * center.y > farthest * farthest) return;
    if (beams_.IsHalf() && center.y < -reach_m - kBehind) return;
    MeetSides(Placed(corners, pose));
  }

  void MeetSides(const Polygon& outline) {
    for (std::size_t i = 0; i < outline.size(); ++i) MeetEdge({outline[i], outline[(i + 1) % outline.size()]});
  }

  /// Returns the ranges in the order of the fan; infinity beyond range_max_m.
  std::vector<double> Take(double range_max_m) {
    if (is_inside_) return std::vector<double>(ranges_m_.size(), 0.0);
    for (double& range : ranges_m_) {
      range = range > range_max_m ? kInfinity : range;  // NOLINT(bugprone-narrowing-conversions): both are double
    }
    if (beams_.IsInOrder()) return std::move(ranges_m_);
    std::vector<double> ordered(ranges_m_.size());
    for (int beam = 0; beam < beams_.Count(); ++beam) ordered[beam] = ranges_m_[beams_.PlaceOf(beam)];
    return ordered;
  }

 private:
  // A margin larger than any rounding error [m].
  static constexpr double kBehind = 1e-9;

  static double Cross(const base::Point& a, const base::Point& b) { return a.x * b.y - a.y * b.x; }

  base::Point ToLocal(const base::Point& point) const {
    const double dx = point.x - origin_.x, dy = point.y - origin_.y;
    return {cos_ * dx + sin_ * dy, cos_ * dy - sin_ * dx};
  }

  // Returns whether an edge with the fan behind or on it runs between the fan and base_link, which is never inside
  // a solid.
  bool CrossesMount(const base::Point& a, const base::Point& b) const {
    const base::Point edge{b.x - a.x, b.y - a.y};
    if (Cross(edge, {base_.x - a.x, base_.y - a.y}) >= 0.0) return false;
    return (Cross(base_, a) > 0.0) != (Cross(base_, b) > 0.0);
  }

  const SortedBeams& beams_;
  const double range_max2_;
  const double cos_;
  const double sin_;
  const base::Point origin_;
  const base::Point base_;
  const bool is_mounted_apart_;
  bool is_inside_ = false;
  std::vector<double> ranges_m_;
};

FanCaster::FanCaster(const Fan& fan, const std::vector<Solid>& solids, const std::vector<Door>& doors)
    : fan_(Checked(fan)),
      beams_(fan.beams, fan.angle_min_rad, fan.angle_max_rad),
      edges_(EdgesOf(solids, doors), fan.range_max_m) {}

std::vector<double> FanCaster::Cast(const World& world, int robot) const {
  // A robot that is not there gets no returns.
  if (!world.present().at(robot)) return std::vector<double>(fan_.beams, kInfinity);
  View view(fan_, beams_, world.poses().at(robot));
  for (const Edge& edge : edges_.Near(view.origin())) {
    if (edge.door == Edge::kNoDoor || world.doors()[edge.door].closed) view.MeetEdge(edge.segment);
  }
  for (const MovingLeaf& leaf : world.leaves()) {
    const base::Point &hinge = world.doors()[leaf.door].motion.hinge, &origin = view.origin();
    if (std::hypot(hinge.x - origin.x, hinge.y - origin.y) <= leaf.reach_m + fan_.range_max_m)
      view.MeetSides(leaf.outline);
  }
  world.grid().ForEachNear(view.origin(), fan_.range_max_m + world.max_radius(),
                           [&](int other, const base::Pose& pose) {
                             const Robot& body = world.robots()[other];
                             if (other != robot) view.MeetBody(body.footprint, pose, body.radius_m, fan_.range_max_m);
                           });
  if (!world.objects().empty()) {
    const double reach_m = fan_.range_max_m + world.max_object_radius();
    world.object_grid().ForEachNear(view.origin(), reach_m, [&](int object, const base::Pose& pose) {
      view.MeetBody(world.objects()[object].corners, pose, world.objects()[object].radius_m, fan_.range_max_m);
    });
  }
  return view.Take(fan_.range_max_m);
}

void FanCaster::Cast(const World& world, const std::vector<int>& robots, const base::Table<double>& ranges_m) const {
  if (!ranges_m.HasShape(robots.size(), static_cast<std::size_t>(fan_.beams))) {
    throw std::invalid_argument("ranges must have one row per robot and one column per beam");
  }
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const std::vector<double> row = Cast(world, robots[i]);
    std::copy(row.begin(), row.end(), ranges_m.Row(i));
  }
}

}  // namespace robotteamsim::world
