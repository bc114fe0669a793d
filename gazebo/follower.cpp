#include "follower.hpp"

#include <cmath>
#include <gazebo/physics/physics.hh>

#include "parts.hpp"
#include "ros_connection.hpp"

namespace robotteamsim::gazebo_plugins {

Follower::Follower(const gazebo::physics::ModelPtr& model) : model_(model) {
  for (const gazebo::physics::LinkPtr& link : LinksOf(model)) link->SetKinematic(true);
  const boost::function<void(const nav_msgs::OdometryConstPtr&)> put =
      [this](const nav_msgs::OdometryConstPtr& message) { Put(*message); };
  ros::SubscribeOptions options = ros::SubscribeOptions::create<nav_msgs::Odometry>(
      "/" + model->GetName() + "/base_pose_ground_truth", /*queue_size=*/1, put, ros::VoidPtr(), &poses_);
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = StartedNode().subscribe(options);
}

void Follower::BeforePhysicsStep() {
  poses_.callAvailable();
  if (!place_) return;
  const double height_m = model_->WorldPose().Pos().Z();
  model_->SetWorldPose({place_->x_m, place_->y_m, height_m, 0.0, 0.0, place_->yaw_rad});
  place_.reset();
}

void Follower::Put(const nav_msgs::Odometry& message) {
  const auto& pose = message.pose.pose;
  const PlanarPose place{pose.position.x, pose.position.y, 2.0 * std::atan2(pose.orientation.z, pose.orientation.w)};
  if (std::isfinite(place.x_m + place.y_m + place.yaw_rad)) place_ = place;
}

}  // namespace robotteamsim::gazebo_plugins
