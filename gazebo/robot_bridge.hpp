// One robot of Gazebo's world as our nodes see it: commands in, readings out.
#pragma once

#include <geometry_msgs/Twist.h>
#include <ros/callback_queue.h>
#include <ros/subscriber.h>

#include <gazebo/physics/PhysicsTypes.hh>
#include <memory>
#include <optional>
#include <sdf/sdf.hh>

#include "contacts.hpp"
#include "drives.hpp"
#include "held_command.hpp"
#include "laser.hpp"
#include "planar.hpp"
#include "robot_topics.hpp"
#include "ros_connection.hpp"

namespace robotteamsim::gazebo_plugins {

class RobotBridge {
 public:
  // Throws std::exception: the model or the settings do not fit.
  RobotBridge(const gazebo::physics::ModelPtr& model, const sdf::ElementPtr& settings);

  void BeforePhysicsStep();
  void AfterPhysicsStep();
  // Gazebo has put the model back to its start.
  void Restart();

 private:
  void Obey(const geometry_msgs::Twist& twist);

  gazebo::physics::ModelPtr model_;
  std::unique_ptr<Drive> drive_;
  std::optional<Laser> laser_;
  Contacts contacts_;
  HeldCommand command_;
  double step_s_;
  Period step_;
  RobotTopics topics_;
  PlanarPose place_;     // after the last physics step
  PlanarPose odometry_;  // since the start
  PlanarPose place_of_reading_;
  PlanarPose odometry_of_reading_;
  ros::CallbackQueue commands_;
  ros::Subscriber subscriber_;
};

}  // namespace robotteamsim::gazebo_plugins
