#include "robotteamsim/world/doors.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/world/box_bodies.hpp"
#include "robotteamsim/world/nearby_edges.hpp"
#include "robotteamsim/world/outline.hpp"

namespace robotteamsim::world {
namespace {

// A leaf checks after every centimetre of its motion [m] whether something blocks it.
constexpr double kGlance = 0.01;
// The most checks within a substep: a leaf that moves by more than 100 m in one checks less often.
constexpr int kMostGlances = 10'000;

// A leaf this near to its end [of the whole motion] has arrived: the difference is rounding.
constexpr double kAtEnd = 1e-9;

std::vector<Door> Checked(std::vector<Door> doors) {
  for (const Door& door : doors) {
    const LeafMotion& motion = door.motion;
    for (const double value :
         {motion.time_s, motion.angle_rad, motion.shift.x, motion.shift.y, motion.hinge.x, motion.hinge.y}) {
      base::Check(value, "the motion of a door");
    }
    CheckSolid(door.leaf);
    if (motion.time_s < 0.0) throw std::invalid_argument("the time of a door must be >= 0");
  }
  return doors;
}

// Returns an outline relative to the hinge.
Polygon FromHinge(const Polygon& outline, const base::Point& hinge) {
  return Placed(outline, {-hinge.x, -hinge.y, 0.0});
}

}  // namespace

const char* NameOf(LeafActivity activity) {
  switch (activity) {
    case LeafActivity::kOpens:
      return "opens";
    case LeafActivity::kCloses:
      return "closes";
    case LeafActivity::kHeld:
      return "held";
    case LeafActivity::kStill:
      break;
  }
  return "still";
}

Doors::Doors(std::vector<Door> doors) : first_(Checked(std::move(doors))) {}

void Doors::Place(b2World& box, const base::Point& origin) {
  origin_ = origin;
  doors_ = first_;
  leaves_.clear();
  bodies_.clear();
  for (std::size_t i = 0; i < doors_.size(); ++i) {
    const Door& door = doors_[i];
    const LeafMotion& motion = door.motion;
    b2BodyDef still;
    if (motion.time_s == 0.0) {
      still.enabled = door.closed;
      bodies_.push_back(box.CreateBody(&still));
      AddPieces(bodies_.back(), door.leaf, origin);
      continue;
    }
    bodies_.push_back(box.CreateBody(&still));
    AddPieces(bodies_.back(), door.leaf, motion.hinge);
    MovingLeaf leaf{static_cast<int>(i), door.closed ? 0.0 : 1.0, door.closed, false, {}, 0.0};
    leaf.outline = OutlineAt(leaf, leaf.opening);
    leaf.reach_m = ReachOf(FromHinge(door.leaf.outline, motion.hinge)) + std::hypot(motion.shift.x, motion.shift.y);
    leaves_.push_back(leaf);
    PutBody(leaf);
  }
  UpdateStates();
}

void Doors::UpdateStates() {
  std::vector<DoorState> states;
  for (const Door& door : doors_) states.push_back({door.closed, door.closed ? 0.0 : 1.0});
  for (const MovingLeaf& leaf : leaves_) {
    DoorState& state = states[leaf.door];
    state.opening = leaf.opening;
    if (leaf.IsThere()) continue;
    state.activity = leaf.is_held       ? LeafActivity::kHeld
                     : leaf.shall_close ? LeafActivity::kCloses
                                        : LeafActivity::kOpens;
  }
  if (states == states_) return;
  states_ = std::move(states);
  ++version_;
}

Polygon Doors::OutlineAt(const MovingLeaf& leaf, double opening) const {
  const Door& door = doors_[leaf.door];
  const auto& [time_s, angle_rad, shift, hinge] = door.motion;
  const Polygon from_hinge = FromHinge(door.leaf.outline, hinge);
  return Placed(from_hinge, {hinge.x + shift.x * opening, hinge.y + shift.y * opening, angle_rad * opening});
}

// In Box2D a leaf is a static body that is moved: it stops robots that drive at it and never pushes.
void Doors::PutBody(const MovingLeaf& leaf) {
  const auto& [time_s, angle_rad, shift, hinge] = doors_[leaf.door].motion;
  const double x = hinge.x + shift.x * leaf.opening, y = hinge.y + shift.y * leaf.opening;
  bodies_[leaf.door]->SetTransform(ToBox(x - origin_.x, y - origin_.y), static_cast<float>(angle_rad * leaf.opening));
}

void Doors::SetClosed(int door, bool closed) {
  Door& stored = doors_.at(door);
  if (stored.motion.time_s == 0.0) {
    stored.closed = closed;
    bodies_[door]->SetEnabled(closed);
  }
  for (MovingLeaf& leaf : leaves_) {
    if (leaf.door != door) continue;
    leaf.shall_close = closed;
    leaf.is_held = false;
  }
  UpdateStates();
}

// Returns the speed of the fastest corner of a moving leaf [m/s].
double Doors::Pace(const MovingLeaf& leaf) const {
  const LeafMotion& motion = doors_[leaf.door].motion;
  return (std::abs(motion.angle_rad) * leaf.reach_m + std::hypot(motion.shift.x, motion.shift.y)) / motion.time_s;
}

void Doors::Advance(double time_s, const IsBlocked& is_blocked) {
  for (MovingLeaf& leaf : leaves_) {
    if (!leaf.IsThere()) GoOn(leaf, time_s, is_blocked);
  }
}

void Doors::GoOn(MovingLeaf& leaf, double time_s, const IsBlocked& is_blocked) {
  Door& door = doors_[leaf.door];
  const int parts = base::ClampedInt(std::ceil(Pace(leaf) * time_s / kGlance), 0, kMostGlances);
  const double end = leaf.shall_close ? 0.0 : 1.0;
  const double part = (leaf.shall_close ? -1.0 : 1.0) * time_s / door.motion.time_s / parts;
  leaf.is_held = false;
  for (int i = 0; i < parts && !leaf.IsThere() && !leaf.is_held; ++i) {
    const double further = leaf.opening + part;
    const double next = std::abs(end - further) < kAtEnd ? end : std::clamp(further, 0.0, 1.0);
    Polygon outline = OutlineAt(leaf, next);
    if (is_blocked(leaf.outline, outline)) {
      leaf.is_held = true;
    } else {
      leaf.opening = next;
      leaf.outline = std::move(outline);
    }
  }
  door.closed = leaf.opening == 0.0;
  PutBody(leaf);
}

double Doors::Travel(double time_s) const {
  double travel_m = 0.0;
  for (const MovingLeaf& leaf : leaves_) {
    if (!leaf.IsThere()) travel_m = std::max(travel_m, Pace(leaf) * time_s);
  }
  return travel_m;
}

bool Doors::IsLeafNear(const base::Point& point, double distance_m) const {
  for (const MovingLeaf& leaf : leaves_) {
    const base::Point& hinge = doors_[leaf.door].motion.hinge;
    if (std::hypot(point.x - hinge.x, point.y - hinge.y) > leaf.reach_m + distance_m) continue;
    for (std::size_t i = 0; i < leaf.outline.size(); ++i) {
      const base::Segment side{leaf.outline[i], leaf.outline[(i + 1) % leaf.outline.size()]};
      if (DistanceToSegment(point, side) <= distance_m) return true;
    }
  }
  return false;
}

}  // namespace robotteamsim::world
