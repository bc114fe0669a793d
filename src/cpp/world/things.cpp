#include "robotteamsim/world/things.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "robotteamsim/world/box_bodies.hpp"
#include "robotteamsim/world/outline.hpp"

namespace robotteamsim::world {
namespace {

// A thing that has gone less than this [m or rad] has not moved: that much may be rounding.
constexpr double kUnmoved = 1e-6;

constexpr double kGravity = 9.81;  // [m/s^2]

bool IsPositive(double value) { return value > 0.0 && std::isfinite(value); }

Thing Checked(Thing thing) {
  if (!thing.corners.empty()) {
    CheckFootprint(thing.corners, "a thing");
    thing.radius = ReachOf(thing.corners);
  }
  const bool is_fine = IsPositive(thing.radius) && IsPositive(thing.mass) && IsPositive(thing.friction);
  if (!is_fine) throw std::invalid_argument("size, mass and friction of a thing must be > 0");
  return thing;
}

std::vector<Thing> AllChecked(std::vector<Thing> things) {
  for (Thing& thing : things) thing = Checked(std::move(thing));
  return things;
}

base::Pose Normalised(const base::Pose& pose) { return {pose.x, pose.y, base::NormaliseAngle(pose.yaw)}; }

}  // namespace

Things::Things(std::vector<Thing> things) : first_(AllChecked(std::move(things))) {}

void Things::Place(b2World* box, const base::Point& origin) {
  box_ = box;
  origin_ = origin;
  ground_ = nullptr;
  things_ = first_;
  bodies_.clear();
  poses_.clear();
  for (const Thing& thing : things_) Build(thing);
  Changed();
}

void Things::Add(Thing thing) {
  things_.push_back(Checked(std::move(thing)));
  Build(things_.back());
  Changed();
}

void Things::Build(const Thing& thing) {
  const b2BodyDef still;
  if (ground_ == nullptr) ground_ = box_->CreateBody(&still);
  b2BodyDef def;
  def.type = b2_dynamicBody;
  def.position = ToBox(thing.start.x - origin_.x, thing.start.y - origin_.y);
  def.angle = static_cast<float>(base::NormaliseAngle(thing.start.yaw));
  def.bullet = true;
  b2Body* body = box_->CreateBody(&def);
  if (thing.corners.empty()) {
    AddDisc(body, thing.radius, thing.mass);
  } else {
    AddPolygon(body, thing.corners, thing.mass);
  }
  const double weight = kGravity * thing.mass;
  b2FrictionJointDef rub;
  rub.Initialize(ground_, body, body->GetWorldCenter());
  rub.maxForce = static_cast<float>(thing.friction * weight);
  // The mean distance of a disc's points from its middle is two thirds of its radius.
  rub.maxTorque = static_cast<float>(thing.friction * weight * 2.0 / 3.0 * thing.radius);
  box_->CreateJoint(&rub);
  bodies_.push_back(body);
  poses_.push_back(Normalised(thing.start));
}

void Things::Remove(int thing) {
  box_->DestroyBody(bodies_.at(thing));
  bodies_.erase(bodies_.begin() + thing);
  poses_.erase(poses_.begin() + thing);
  things_.erase(things_.begin() + thing);
  Changed();
}

void Things::SetPose(int thing, const base::Pose& pose) {
  poses_.at(thing) = Normalised(pose);
  b2Body* const body = bodies_[thing];
  body->SetTransform(ToBox(pose.x - origin_.x, pose.y - origin_.y), static_cast<float>(poses_[thing].yaw));
  body->SetLinearVelocity(b2Vec2_zero);
  body->SetAngularVelocity(0.0F);
  body->SetAwake(true);
  Changed();
}

void Things::Changed() {
  max_radius_ = 0.0;
  for (const Thing& thing : things_) max_radius_ = std::max(max_radius_, thing.radius);
  grid_.Rebuild(poses_);
}

void Things::FinishStep() {
  bool any = false;
  for (std::size_t i = 0; i < things_.size(); ++i) {
    if (!bodies_[i]->IsAwake()) continue;
    const base::Pose pose = PoseNow(static_cast<int>(i));
    // A thing that nobody has pushed yet stays where it was placed, in double precision.
    const base::Pose way = base::RelativePose(poses_[i], pose);
    if (std::hypot(way.x, way.y) < kUnmoved && std::abs(way.yaw) < kUnmoved) continue;
    poses_[i] = pose;
    any = true;
  }
  if (any) grid_.Rebuild(poses_);
}

base::Pose Things::PoseNow(int thing) const {
  const b2Body* const body = bodies_[thing];
  const b2Vec2& at = body->GetPosition();
  return {origin_.x + at.x, origin_.y + at.y, base::NormaliseAngle(static_cast<double>(body->GetAngle()))};
}

bool Things::AnyMoves() const {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const b2Body* body) { return body->IsAwake(); });
}

double Things::Travel(double time) const {
  double speed = 0.0;
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const double turning = things_[i].radius * std::abs(static_cast<double>(bodies_[i]->GetAngularVelocity()));
    speed = std::max(speed, static_cast<double>(bodies_[i]->GetLinearVelocity().Length()) + turning);
  }
  return speed * time;
}

}  // namespace robotteamsim::world
