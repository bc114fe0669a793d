// The topics that a robot publishes, with the names and frames of docs/ros_api.md.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/publisher.h>
#include <sensor_msgs/LaserScan.h>

#include <ignition/math/Pose3.hh>
#include <optional>
#include <string>
#include <vector>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

// What a robot knows after a step.
struct RobotReading {
  PlanarPose odometry;  // from its start
  PlanarTwist wheels;
  PlanarPose ground_truth;  // in map
  PlanarTwist motion;
  std::optional<sensor_msgs::LaserScan> scan;
  std::vector<double> contact_angles_rad;
};

class RobotTopics {
 public:
  // Args: name: of the robot, before each topic and frame. laser: its pose in base_link; none: it has no laser.
  //       is_localised: whether tf contains map -> odom, without error.
  RobotTopics(std::string name, const std::optional<ignition::math::Pose3d>& laser, bool is_localised);

  void Publish(RobotReading reading, const ros::Time& stamp) const;

 private:
  std::string Frame(const std::string& frame) const { return name_ + "/" + frame; }
  nav_msgs::Odometry Odometry(const std::string& frame, const PlanarPose& pose, const PlanarTwist& twist) const;
  void PublishFrames(const RobotReading& reading, const ros::Time& stamp) const;

  std::string name_;
  bool is_localised_;
  std::vector<geometry_msgs::TransformStamped> fixed_;
  ros::Publisher odometry_;
  ros::Publisher ground_truth_;
  ros::Publisher scan_;
  ros::Publisher contact_;
  ros::Publisher frames_;
};

}  // namespace robotteamsim::gazebo_plugins
