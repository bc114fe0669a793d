#include "robot_bridge.hpp"

#include <ros/console.h>
#include <ros/param.h>

#include <gazebo/physics/physics.hh>
#include <stdexcept>
#include <string>
#include <utility>

#include "parts.hpp"

namespace robotteamsim::gazebo_plugins {
namespace {

constexpr int kCommandsKept = 100;
constexpr double kWarningPeriodS = 1.0;

bool IsLocalised() {
  StartedNode();
  const std::string source = ros::param::param<std::string>("~localization", "none");
  if (source != "none" && source != "ground_truth") {
    throw std::invalid_argument("~localization: '" + source + "'; expected none or ground_truth");
  }
  return source == "ground_truth";
}

std::optional<ignition::math::Pose3d> Mount(const std::optional<Laser>& laser) {
  return laser ? std::optional(laser->mount()) : std::nullopt;
}

}  // namespace

RobotBridge::RobotBridge(const gazebo::physics::ModelPtr& model, const sdf::ElementPtr& settings)
    : model_(model),
      drive_(MakeDrive(model, settings)),
      laser_(Laser::Of(model, settings)),
      contacts_(model),
      command_(settings->Get<double>("cmd_vel_hold_s", 0.8).first),
      step_s_(settings->Get<double>("step_s", 0.1).first),
      step_(step_s_),
      topics_(model->GetName(), Mount(laser_), IsLocalised()),
      place_(PlaceOf(model)),
      place_of_reading_(place_) {
  const boost::function<void(const geometry_msgs::TwistConstPtr&)> obey =
      [this](const geometry_msgs::TwistConstPtr& twist) { Obey(*twist); };
  ros::SubscribeOptions options = ros::SubscribeOptions::create<geometry_msgs::Twist>(
      "/" + model->GetName() + "/cmd_vel", kCommandsKept, obey, ros::VoidPtr(), &commands_);
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = StartedNode().subscribe(options);
}

void RobotBridge::BeforePhysicsStep() {
  commands_.callAvailable();
  const PlanarTwist command = command_.At(TimeNs(model_->GetWorld()));
  drive_->Apply(command, model_->GetWorld()->Physics()->GetMaxStepSize());
}

void RobotBridge::AfterPhysicsStep() {
  const double duration_s = model_->GetWorld()->Physics()->GetMaxStepSize();
  const PlanarPose place = PlaceOf(model_);
  odometry_ = odometry_ * drive_->Measured(Inverse(place_) * place, duration_s);
  place_ = place;
  contacts_.Note();
  const std::int64_t now_ns = TimeNs(model_->GetWorld());
  if (!step_.IsDue(now_ns)) return;
  // Velocities are those of the whole step.
  RobotReading reading{odometry_, Velocity(Inverse(odometry_of_reading_) * odometry_, step_s_),
                       place_,    Velocity(Inverse(place_of_reading_) * place_, step_s_),
                       {},        {}};
  odometry_of_reading_ = odometry_;
  place_of_reading_ = place_;
  if (laser_) reading.scan = laser_->Scan();
  reading.contact_angles_rad = contacts_.TakeAngles();
  topics_.Publish(std::move(reading), Stamp(now_ns));
}

void RobotBridge::Restart() {
  command_.Clear();
  place_ = place_of_reading_ = PlaceOf(model_);
  odometry_ = odometry_of_reading_ = {};
}

void RobotBridge::Obey(const geometry_msgs::Twist& twist) {
  const PlanarTwist command{twist.linear.x, twist.linear.y, twist.angular.z};
  if (!command_.Put(command, TimeNs(model_->GetWorld()))) {
    ROS_WARN_THROTTLE(kWarningPeriodS, "%s: ignoring a command that is not finite", model_->GetName().c_str());
  }
}

}  // namespace robotteamsim::gazebo_plugins
