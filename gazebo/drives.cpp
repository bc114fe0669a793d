#include "drives.hpp"

#include <cmath>
#include <gazebo/physics/physics.hh>
#include <stdexcept>
#include <string>

#include "limits.hpp"
#include "parts.hpp"

namespace robotteamsim::gazebo_plugins {
namespace {

namespace physics = gazebo::physics;
using ignition::math::Vector3d;

class VelocityDrive : public Drive {
 public:
  VelocityDrive(const physics::ModelPtr& model, const sdf::ElementPtr& settings)
      : model_(model), links_(LinksOf(model)), limits_(settings) {
    for (const physics::LinkPtr& link : links_) {
      link->SetGravityMode(false);
      link->SetAutoDisable(false);
    }
  }

  void Apply(const PlanarTwist& command, double duration_s) override {
    const ignition::math::Pose3d pose = model_->WorldPose();
    const ignition::math::Quaterniond heading(0.0, 0.0, pose.Rot().Yaw());
    // That of the body, so that a blocked robot does not go on accelerating.
    const physics::LinkPtr& body = links_.front();
    const Vector3d spin = body->WorldAngularVel();
    const Vector3d now =
        heading.RotateVectorReverse(body->WorldLinearVel() + spin.Cross(pose.Pos() - body->WorldPose().Pos()));
    const PlanarTwist next = limits_.Next({now.X(), now.Y(), spin.Z()}, command, duration_s);
    const Vector3d velocity = heading.RotateVector({next.forward_mps, next.left_mps, 0.0});
    const Vector3d turn(0.0, 0.0, next.turn_radps);
    for (const physics::LinkPtr& link : links_) {
      // As parts of one rigid body, so that no joint has to pull them.
      link->SetLinearVel(velocity + turn.Cross(link->WorldCoGPose().Pos() - pose.Pos()));
      link->SetAngularVel(turn);
    }
  }

  PlanarPose Measured(const PlanarPose& true_motion, double /*duration_s*/) const override { return true_motion; }

 private:
  physics::ModelPtr model_;
  physics::Link_V links_;
  Limits limits_;
};

double Radius(const physics::LinkPtr& wheel) {
  for (const physics::CollisionPtr& collision : wheel->GetCollisions()) {
    const physics::ShapePtr shape = collision->GetShape();
    if (const auto cylinder = boost::dynamic_pointer_cast<physics::CylinderShape>(shape)) return cylinder->GetRadius();
    if (const auto sphere = boost::dynamic_pointer_cast<physics::SphereShape>(shape)) return sphere->GetRadius();
  }
  throw std::invalid_argument("link '" + wheel->GetName() +
                              "': expected a wheel whose collision is a cylinder or sphere");
}

class Wheel {
 public:
  Wheel(const physics::ModelPtr& model, const sdf::ElementPtr& settings, const std::string& element, double torque_nm)
      : torque_nm_(torque_nm) {
    const auto name =
        settings->Get<std::string>(element, element == "left_joint" ? "left_wheel_joint" : "right_wheel_joint");
    joint_ = model->GetJoint(name.first);
    if (!joint_ || !joint_->GetChild()) {
      throw std::invalid_argument("<" + element + ">: the model has no joint '" + name.first + "' to a wheel");
    }
    radius_m_ = Radius(joint_->GetChild());
    const Vector3d left = model->WorldPose().Rot().RotateVector({0.0, 1.0, 0.0});
    forward_ = joint_->GlobalAxis(0).Dot(left) < 0.0 ? -1.0 : 1.0;
  }

  Vector3d Place() const { return joint_->Anchor(0); }

  void Turn(double speed_mps) {
    joint_->SetParam("fmax", 0, torque_nm_);
    joint_->SetParam("vel", 0, forward_ * speed_mps / radius_m_);
  }

  double Speed() const { return forward_ * joint_->GetVelocity(0) * radius_m_; }

 private:
  physics::JointPtr joint_;
  double torque_nm_;
  double radius_m_ = 0.0;
  double forward_ = 1.0;
};

class WheelDrive : public Drive {
 public:
  WheelDrive(const physics::ModelPtr& model, const sdf::ElementPtr& settings)
      : WheelDrive(model, settings, settings->Get<double>("max_torque", 5.0).first) {}

  void Apply(const PlanarTwist& command, double duration_s) override {
    wanted_ = limits_.Next(wanted_, command, duration_s);
    const double turn_mps = 0.5 * separation_m_ * wanted_.turn_radps;
    left_.Turn(wanted_.forward_mps - turn_mps);
    right_.Turn(wanted_.forward_mps + turn_mps);
  }

  PlanarPose Measured(const PlanarPose& /*true_motion*/, double duration_s) const override {
    const double distance_m = 0.5 * (left_.Speed() + right_.Speed()) * duration_s;
    const double angle_rad = (right_.Speed() - left_.Speed()) / separation_m_ * duration_s;
    return {distance_m * std::cos(0.5 * angle_rad), distance_m * std::sin(0.5 * angle_rad), angle_rad};
  }

 private:
  WheelDrive(const physics::ModelPtr& model, const sdf::ElementPtr& settings, double torque_nm)
      : left_(model, settings, "left_joint", torque_nm),
        right_(model, settings, "right_joint", torque_nm),
        limits_(settings) {
    separation_m_ = left_.Place().Distance(right_.Place());
    if (!(separation_m_ > 0.0)) throw std::invalid_argument("the two wheels are at the same place");
    for (const physics::LinkPtr& link : LinksOf(model)) link->SetAutoDisable(false);
  }

  Wheel left_;
  Wheel right_;
  Limits limits_;
  PlanarTwist wanted_;  // in the last physics step
  double separation_m_;
};

}  // namespace

std::unique_ptr<Drive> MakeDrive(const physics::ModelPtr& model, const sdf::ElementPtr& settings) {
  const std::string kind = settings->Get<std::string>("drive", "velocity").first;
  if (kind == "velocity") return std::make_unique<VelocityDrive>(model, settings);
  if (kind == "wheels") return std::make_unique<WheelDrive>(model, settings);
  throw std::invalid_argument("<drive>: '" + kind + "'; expected velocity or wheels");
}

}  // namespace robotteamsim::gazebo_plugins
