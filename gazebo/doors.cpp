#include "doors.hpp"

#include <algorithm>
#include <cmath>
#include <gazebo/physics/physics.hh>
#include <limits>
#include <stdexcept>

namespace robotteamsim::gazebo_plugins {
namespace {

namespace physics = gazebo::physics;

const std::string kPrefix = "door_";
constexpr double kClearanceM = 0.005;

double OtherLimit(const physics::JointPtr& joint) {
  const double lower = joint->LowerLimit(0);
  const double upper = joint->UpperLimit(0);
  return std::abs(lower) > std::abs(upper) ? lower : upper;
}

}  // namespace

Door::Door(const physics::WorldPtr& world, const sdf::ElementPtr& settings)
    : world_(world),
      closed_at_start_(settings->Get<bool>("closed", true).first),
      time_s_(settings->Get<double>("time_s", 0.0).first) {
  const std::string model = settings->Get<std::string>("model", "").first;
  const std::string joint = settings->Get<std::string>("joint", "leaf_joint").first;
  model_ = world->ModelByName(model);
  if (!model_) throw std::invalid_argument("<door>: the world has no model '" + model + "'");
  joint_ = model_->GetJoint(joint);
  if (!joint_ || !joint_->GetChild())
    throw std::invalid_argument("<door>: model '" + model + "' has no joint '" + joint + "'");
  name_ = model.compare(0, kPrefix.size(), kPrefix) == 0 ? model.substr(kPrefix.size()) : model;
  other_ = OtherLimit(joint_);
  // Only the joint moves it, not what it touches.
  joint_->GetChild()->SetKinematic(true);
  joint_->GetChild()->SetAutoDisable(false);
}

void Door::Move(double duration_s) {
  const double target = wants_other_ ? other_ : 0.0;
  if (position_ == target) {
    motion_ = "still";
    return;
  }
  const double before_m = Clearance();
  const double next = Next(duration_s);
  joint_->SetPosition(0, next);
  const double after_m = Clearance();
  if (after_m < kClearanceM && after_m < before_m) {
    joint_->SetPosition(0, position_);
    motion_ = "held";
    return;
  }
  position_ = next;
  if (position_ == target) {
    motion_ = "still";
  } else {
    motion_ = wants_other_ == closed_at_start_ ? "opens" : "closes";
  }
}

double Door::Next(double duration_s) const {
  const double target = wants_other_ ? other_ : 0.0;
  if (!(time_s_ > 0.0)) return target;
  const double step = std::abs(other_) * duration_s / time_s_;
  return position_ + std::clamp(target - position_, -step, step);
}

double Door::Clearance() const {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const physics::ModelPtr& model : world_->Models()) {
    if (model->IsStatic() || model->GetName().compare(0, kPrefix.size(), kPrefix) == 0) continue;
    nearest_m = std::min(nearest_m, Distance(model));
  }
  return nearest_m;
}

double Door::Distance(const physics::ModelPtr& model) const {
  const physics::CollisionPtr leaf = joint_->GetChild()->GetCollisions().front();
  const auto box = boost::dynamic_pointer_cast<physics::BoxShape>(leaf->GetShape());
  const ignition::math::Vector3d half = box ? 0.5 * box->Size() : ignition::math::Vector3d::Zero;
  const ignition::math::AxisAlignedBox around = model->BoundingBox();
  // The model counts as an upright cylinder.
  const double radius_m = 0.5 * std::max(around.XLength(), around.YLength());
  const ignition::math::Pose3d pose = leaf->WorldPose();
  const ignition::math::Vector3d place = pose.Rot().RotateVectorReverse(around.Center() - pose.Pos());
  if (std::abs(place.Z()) > half.Z() + 0.5 * around.ZLength()) return std::numeric_limits<double>::infinity();
  const double dx_m = std::max(std::abs(place.X()) - half.X(), 0.0);
  const double dy_m = std::max(std::abs(place.Y()) - half.Y(), 0.0);
  return std::hypot(dx_m, dy_m) - radius_m;
}

robotteamsim::Door Door::State() const {
  const double share = other_ == 0.0 ? 0.0 : position_ / other_;
  robotteamsim::Door state;
  state.name = name_;
  state.opening = closed_at_start_ ? share : 1.0 - share;
  state.closed = state.opening == 0.0;
  state.motion = motion_;
  return state;
}

Doors::Doors(const physics::WorldPtr& world, const sdf::ElementPtr& settings) {
  if (!settings->HasElement("door")) return;
  for (sdf::ElementPtr door = settings->GetElement("door"); door; door = door->GetNextElement("door")) {
    doors_.emplace_back(world, door);
  }
}

void Doors::Request(const std::string& name, bool closed) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (Door& door : doors_) {
    if (door.name() == name) return door.SetWanted(closed);
  }
  std::string names;
  for (const Door& door : doors_) names += (names.empty() ? "" : ", ") + door.name();
  throw std::invalid_argument("unknown door '" + name + "'; known: " + (names.empty() ? "none" : names));
}

void Doors::Move(double duration_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (Door& door : doors_) door.Move(duration_s);
}

robotteamsim::Doors Doors::States() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  robotteamsim::Doors message;
  for (const Door& door : doors_) message.doors.push_back(door.State());
  return message;
}

}  // namespace robotteamsim::gazebo_plugins
