#include "robotteamsim/sensing/laser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/simd.hpp"

namespace robotteamsim::sensing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSharedSight = 0.09;  // 5 degrees
constexpr int kMostBeams = 1'000'000;

LaserModel Checked(const LaserModel& model) {
  if (model.beams < 1) throw std::invalid_argument("beams must be >= 1, got " + std::to_string(model.beams));
  if (model.beams > kMostBeams) throw std::invalid_argument("beams must be at most a million");
  if (!(model.range_max > model.range_min)) throw std::invalid_argument("range_max must be > range_min");
  if (!(model.range_min >= 0.0)) throw std::invalid_argument("range_min must be >= 0");
  for (const double value : {model.angle_min, model.angle_max, model.forward, model.left}) {
    if (!base::IsUsable(value)) throw std::invalid_argument("angles and position of a laser must be finite");
  }
  base::CheckPositive(model.range_max, "range_max");
  if (std::isnan(model.too_near) || std::isnan(model.no_return)) {
    throw std::invalid_argument("too_near and no_return must be numbers");
  }
  return model;
}

double Cross(const base::Point& a, const base::Point& b) { return a.x * b.y - a.y * b.x; }

ROBOTTEAMSIM_INLINE void WriteReport(const LaserModel& model, const double* __restrict ranges,
                                     const double* __restrict noise, std::size_t beams, float* __restrict report) {
  const double least = model.range_min, most = model.range_max, no_return = model.no_return, near = model.too_near;
  // A NaN counts as too near: the robot stops.
  const auto reported = [=](double range) {
    return static_cast<float>(range > most ? no_return : range >= least ? range : near);
  };
  if (noise == nullptr) {
    for (std::size_t beam = 0; beam < beams; ++beam) report[beam] = reported(ranges[beam]);
  } else {
    for (std::size_t beam = 0; beam < beams; ++beam) report[beam] = reported(ranges[beam] + noise[beam]);
  }
}

#define ROBOTTEAMSIM_REPORT(Name, attributes)                                                                         \
  attributes void Name##Report(const LaserModel& model, const double* ranges, const double* noise, std::size_t beams, \
                               float* report) {                                                                       \
    WriteReport(model, ranges, noise, beams, report);                                                                 \
  }
// Wider registers than those of AVX2 do not make it faster.
ROBOTTEAMSIM_REPORT(Portable, )
ROBOTTEAMSIM_REPORT(Avx2, ROBOTTEAMSIM_AVX2)

}  // namespace

class Laser::View {
 public:
  View(const LaserModel& model, const BeamFan& fan, const base::Pose& base)
      : fan_(fan),
        range_max2_(model.range_max * model.range_max),
        cos_(std::cos(base.yaw + fan.Zero())),
        sin_(std::sin(base.yaw + fan.Zero())),
        origin_{base.x + model.forward * std::cos(base.yaw) - model.left * std::sin(base.yaw),
                base.y + model.forward * std::sin(base.yaw) + model.left * std::cos(base.yaw)},
        base_(ToLocal({base.x, base.y})),
        is_mounted_apart_(model.forward != 0.0 || model.left != 0.0),
        ranges_(fan.Count(), kInfinity) {}

  const base::Point& origin() const { return origin_; }

  void MeetEdge(const base::Segment& edge) {
    const base::Point a = ToLocal(edge.a), b = ToLocal(edge.b);
    const double cross = Cross(a, b);
    if (cross >= 0.0) {  // the laser is behind the edge, inside the solid, or on its line
      if (is_mounted_apart_ && CrossesMount(a, b)) is_inside_ = true;
      return;
    }
    if (fan_.IsHalf() && a.y < -kBehind && b.y < -kBehind) return;
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double a2 = a.x * a.x + a.y * a.y, b2 = b.x * b.x + b.y * b.y, length2 = dx * dx + dy * dy;
    const double along =
        -(a.x * dx + a.y * dy);  // of the foot of the perpendicular, in units of the edge times length2
    const double nearest2 = along <= 0.0 ? a2 : along >= length2 ? b2 : cross * cross / length2;
    if (nearest2 > range_max2_) return;
    const double nearest = std::sqrt(nearest2), farthest = std::sqrt(std::max(a2, b2));
    const double* const x = fan_.X();
    const double* const y = fan_.Y();
    double* const ranges = ranges_.data();
    fan_.ForBeamsBetween(PseudoAngle(b.x, b.y), PseudoAngle(a.x, a.y), [&](int first, int end) {
      for (int i = first; i < end; ++i) {
        const double range = cross / (x[i] * dy - y[i] * dx);
        // A beam almost parallel to the edge may intersect its line far away: use the nearest end.
        const double met = range >= nearest ? std::min(range, farthest) : nearest;
        ranges[i] = std::min(ranges[i], met);
      }
    });
  }

  void MeetDisc(const base::Pose& disc, double radius, double range_max) {
    const base::Point center = ToLocal({disc.x, disc.y});
    const double distance2 = center.x * center.x + center.y * center.y;
    const double reach = range_max + radius, radius2 = radius * radius;
    if (distance2 > reach * reach) return;
    if (distance2 <= radius2) {
      is_inside_ = true;
      return;
    }
    if (fan_.IsHalf() && center.y < -radius - kBehind) return;
    const double tangent = std::sqrt(distance2 - radius2);
    const double right = PseudoAngle(center.x * tangent + center.y * radius, center.y * tangent - center.x * radius);
    const double left = PseudoAngle(center.x * tangent - center.y * radius, center.y * tangent + center.x * radius);
    const double* const x = fan_.X();
    const double* const y = fan_.Y();
    double* const ranges = ranges_.data();
    fan_.ForBeamsBetween(right, left, [&](int first, int end) {
      for (int i = first; i < end; ++i) {
        const double along = center.x * x[i] + center.y * y[i];
        const double half_chord2 = radius2 - (distance2 - along * along);
        const double met = half_chord2 >= 0.0 ? along - std::sqrt(std::max(half_chord2, 0.0)) : kInfinity;
        ranges[i] = std::min(ranges[i], met);
      }
    });
  }

  /// Args: corners: of a polygon in the frame of its pose; empty: a disc. reach: radius of the body.
  void MeetBody(const world::Polygon& corners, const base::Pose& pose, double reach, double range_max) {
    if (corners.empty()) {
      MeetDisc(pose, reach, range_max);
    } else {
      MeetPolygon(corners, pose, reach, range_max);
    }
  }

  void MeetPolygon(const world::Polygon& corners, const base::Pose& pose, double reach, double range_max) {
    const base::Point center = ToLocal({pose.x, pose.y});
    const double farthest = range_max + reach;
    if (center.x * center.x + center.y * center.y > farthest * farthest) return;
    if (fan_.IsHalf() && center.y < -reach - kBehind) return;
    MeetSides(world::Placed(corners, pose));
  }

  void MeetSides(const world::Polygon& outline) {
    for (std::size_t i = 0; i < outline.size(); ++i) MeetEdge({outline[i], outline[(i + 1) % outline.size()]});
  }

  /// Returns the ranges in the laser's order; infinity beyond range_max.
  std::vector<double> Take(double range_max) {
    if (is_inside_) return std::vector<double>(ranges_.size(), 0.0);
    for (double& range : ranges_) {
      range = range > range_max ? kInfinity : range;  // NOLINT(bugprone-narrowing-conversions): both are double
    }
    if (fan_.IsInOrder()) return std::move(ranges_);
    std::vector<double> ordered(ranges_.size());
    for (int beam = 0; beam < fan_.Count(); ++beam) ordered[beam] = ranges_[fan_.PlaceOf(beam)];
    return ordered;
  }

 private:
  // A margin larger than any rounding error [m].
  static constexpr double kBehind = 1e-9;

  base::Point ToLocal(const base::Point& point) const {
    const double dx = point.x - origin_.x, dy = point.y - origin_.y;
    return {cos_ * dx + sin_ * dy, cos_ * dy - sin_ * dx};
  }

  // Returns whether an edge with the laser behind or on it runs between the laser and base_link, which is never inside
  // a solid.
  bool CrossesMount(const base::Point& a, const base::Point& b) const {
    const base::Point edge{b.x - a.x, b.y - a.y};
    if (Cross(edge, {base_.x - a.x, base_.y - a.y}) >= 0.0) return false;
    return (Cross(base_, a) > 0.0) != (Cross(base_, b) > 0.0);
  }

  const BeamFan& fan_;
  const double range_max2_;
  const double cos_;
  const double sin_;
  const base::Point origin_;
  const base::Point base_;
  const bool is_mounted_apart_;
  bool is_inside_ = false;
  std::vector<double> ranges_;
};

Laser::Laser(const LaserModel& model, const std::vector<world::Solid>& solids, const std::vector<world::Door>& doors)
    : model_(Checked(model)),
      write_report_(base::SimdVersion(base::BestSimd(), PortableReport, Avx2Report, Avx2Report)),
      fan_(model.beams, model.angle_min, model.angle_max),
      edges_(world::EdgesOf(solids, doors), model.range_max) {}

std::vector<double> Laser::Scan(const world::World& world, int robot) const {
  // A robot that is not there gets no returns.
  if (!world.present().at(robot)) return std::vector<double>(NumBeams(), kInfinity);
  View view(model_, fan_, world.poses().at(robot));
  for (const world::Edge& edge : edges_.Near(view.origin())) {
    if (edge.door == world::Edge::kNoDoor || world.doors()[edge.door].closed) view.MeetEdge(edge.segment);
  }
  for (const world::MovingLeaf& leaf : world.leaves()) {
    const base::Point &hinge = world.doors()[leaf.door].motion.hinge, &laser = view.origin();
    if (std::hypot(hinge.x - laser.x, hinge.y - laser.y) <= leaf.reach + model_.range_max) view.MeetSides(leaf.outline);
  }
  world.grid().ForEachNear(view.origin(), model_.range_max + world.max_radius(),
                           [&](int other, const base::Pose& pose) {
                             const world::Robot& body = world.robots()[other];
                             if (other != robot) view.MeetBody(body.footprint, pose, body.radius, model_.range_max);
                           });
  if (!world.objects().empty()) {
    const double reach = model_.range_max + world.max_object_radius();
    world.object_grid().ForEachNear(view.origin(), reach, [&](int object, const base::Pose& pose) {
      view.MeetBody(world.objects()[object].corners, pose, world.objects()[object].radius, model_.range_max);
    });
  }
  return view.Take(model_.range_max);
}

void Laser::Report(const std::vector<double>& ranges, const double* noise, float* report) const {
  write_report_(model_, ranges.data(), noise, ranges.size(), report);
}

void Laser::Dim(const world::World& world, int robot, const hazards::Haze& haze, float* report) const {
  if (!world.present().at(robot)) return;
  const base::Pose& base = world.poses()[robot];
  const double cos = std::cos(base.yaw), sin = std::sin(base.yaw);
  const base::Point origin{base.x + model_.forward * cos - model_.left * sin,
                           base.y + model_.forward * sin + model_.left * cos};
  if (haze.IsClearAround(origin, model_.range_max)) return;
  const double step = model_.beams > 1 ? (model_.angle_max - model_.angle_min) / (model_.beams - 1) : 0.0;
  // Smoke is so smooth that neighbouring beams share the sight along their middle.
  const int shared = std::max(1, step > 0.0 ? base::ClampedInt(kSharedSight / step, 1, model_.beams) : 1);
  for (int first = 0; first < model_.beams; first += shared) {
    const int end = std::min(first + shared, model_.beams);
    const double angle = base.yaw + model_.angle_min + 0.5 * (first + end - 1) * step;
    const double sight = haze.Sight(origin, {std::cos(angle), std::sin(angle)}, model_.range_max);
    if (sight >= model_.range_max) continue;
    for (int beam = first; beam < end; ++beam) {
      if (report[beam] > sight && report[beam] <= model_.range_max) report[beam] = static_cast<float>(model_.no_return);
    }
  }
}

}  // namespace robotteamsim::sensing
