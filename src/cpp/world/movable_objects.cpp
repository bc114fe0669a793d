#include "robotteamsim/world/movable_objects.hpp"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/world/box_bodies.hpp"
#include "robotteamsim/world/outline.hpp"

namespace robotteamsim::world {
namespace {

// An object that moved by less than this [m or rad] has not moved: the difference may be rounding.
constexpr double kUnmoved = 1e-6;

constexpr double kGravity = 9.81;  // [m/s^2]

MovableObject Checked(MovableObject object) {
  if (!object.corners.empty()) {
    CheckFootprint(object.corners, "an object");
    object.radius_m = ReachOf(object.corners);
  }
  const bool is_fine =
      base::IsPositive(object.radius_m) && base::IsPositive(object.mass_kg) && base::IsPositive(object.friction);
  if (!is_fine) throw std::invalid_argument("size, mass and friction of an object must be > 0");
  base::Check(object.start, "the pose of an object");
  return object;
}

std::vector<MovableObject> AllChecked(std::vector<MovableObject> objects) {
  for (MovableObject& object : objects) object = Checked(std::move(object));
  return objects;
}

base::Pose Normalised(const base::Pose& pose) { return {pose.x, pose.y, base::NormaliseAngle(pose.yaw)}; }

}  // namespace

MovableObjects::MovableObjects(std::vector<MovableObject> objects) : first_(AllChecked(std::move(objects))) {}

void MovableObjects::Place(b2World* box, const base::Point& origin) {
  box_ = box;
  origin_ = origin;
  ground_ = nullptr;
  objects_ = first_;
  bodies_.clear();
  poses_.clear();
  for (const MovableObject& object : objects_) Build(object);
  Changed();
}

void MovableObjects::Add(MovableObject object) {
  objects_.push_back(Checked(std::move(object)));
  Build(objects_.back());
  Changed();
}

void MovableObjects::Build(const MovableObject& object) {
  const b2BodyDef still;
  if (ground_ == nullptr) ground_ = box_->CreateBody(&still);
  b2BodyDef def;
  def.type = b2_dynamicBody;
  def.position = ToBox(object.start.x - origin_.x, object.start.y - origin_.y);
  def.angle = static_cast<float>(base::NormaliseAngle(object.start.yaw));
  def.bullet = true;
  b2Body* body = box_->CreateBody(&def);
  if (object.corners.empty()) {
    AddDisc(body, object.radius_m, object.mass_kg);
  } else {
    AddPolygon(body, object.corners, object.mass_kg);
  }
  const double weight = kGravity * object.mass_kg;
  b2FrictionJointDef rub;
  rub.Initialize(ground_, body, body->GetWorldCenter());
  rub.maxForce = static_cast<float>(object.friction * weight);
  // The mean distance of a disc's points from its middle is two thirds of its radius.
  rub.maxTorque = static_cast<float>(object.friction * weight * 2.0 / 3.0 * object.radius_m);
  box_->CreateJoint(&rub);
  bodies_.push_back(body);
  poses_.push_back(Normalised(object.start));
}

void MovableObjects::CheckIndex(int object) const {
  if (object < 0 || object >= static_cast<int>(objects_.size())) throw std::out_of_range("no such object");
}

void MovableObjects::Remove(int object) {
  CheckIndex(object);
  box_->DestroyBody(bodies_[object]);
  bodies_.erase(bodies_.begin() + object);
  poses_.erase(poses_.begin() + object);
  objects_.erase(objects_.begin() + object);
  Changed();
}

void MovableObjects::SetPose(int object, const base::Pose& pose) {
  CheckIndex(object);
  base::Check(pose, "the pose of an object");
  poses_[object] = Normalised(pose);
  b2Body* const body = bodies_[object];
  body->SetTransform(ToBox(pose.x - origin_.x, pose.y - origin_.y), static_cast<float>(poses_[object].yaw));
  body->SetLinearVelocity(b2Vec2_zero);
  body->SetAngularVelocity(0.0F);
  body->SetAwake(true);
  Changed();
}

void MovableObjects::Changed() {
  max_radius_m_ = 0.0;
  for (const MovableObject& object : objects_) max_radius_m_ = std::max(max_radius_m_, object.radius_m);
  grid_.Rebuild(poses_);
}

void MovableObjects::FinishStep() {
  bool any = false;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (!bodies_[i]->IsAwake()) continue;
    const base::Pose pose = PoseNow(static_cast<int>(i));
    // An object that was not pushed yet stays exactly where it was placed, in double precision.
    const base::Pose moved = base::RelativePose(poses_[i], pose);
    if (std::hypot(moved.x, moved.y) < kUnmoved && std::abs(moved.yaw) < kUnmoved) continue;
    poses_[i] = pose;
    any = true;
  }
  if (any) grid_.Rebuild(poses_);
}

base::Pose MovableObjects::PoseNow(int object) const {
  const b2Body* const body = bodies_[object];
  const b2Vec2& at = body->GetPosition();
  return {origin_.x + at.x, origin_.y + at.y, base::NormaliseAngle(static_cast<double>(body->GetAngle()))};
}

bool MovableObjects::AnyMoves() const {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const b2Body* body) { return body->IsAwake(); });
}

double MovableObjects::Travel(double time_s) const {
  double speed = 0.0;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const double turning = objects_[i].radius_m * std::abs(static_cast<double>(bodies_[i]->GetAngularVelocity()));
    speed = std::max(speed, static_cast<double>(bodies_[i]->GetLinearVelocity().Length()) + turning);
  }
  return speed * time_s;
}

}  // namespace robotteamsim::world
