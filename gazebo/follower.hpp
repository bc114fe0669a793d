// A robot that another world moves: its body here follows the pose that is published, so that others see and touch it.
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/subscriber.h>

#include <gazebo/physics/PhysicsTypes.hh>
#include <optional>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

class Follower {
 public:
  explicit Follower(const gazebo::physics::ModelPtr& model);

  void BeforePhysicsStep();

 private:
  void Put(const nav_msgs::Odometry& message);

  gazebo::physics::ModelPtr model_;
  std::optional<PlanarPose> place_;  // the newest one
  ros::CallbackQueue poses_;
  ros::Subscriber subscriber_;
};

}  // namespace robotteamsim::gazebo_plugins
