#include "robot_topics.hpp"

#include <robotteamsim/Contact.h>
#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <utility>

#include "ros_connection.hpp"

namespace robotteamsim::gazebo_plugins {
namespace {

constexpr int kQueue = 100;

geometry_msgs::Quaternion Rotation(double yaw_rad) {
  geometry_msgs::Quaternion rotation;
  rotation.z = std::sin(0.5 * yaw_rad);
  rotation.w = std::cos(0.5 * yaw_rad);
  return rotation;
}

geometry_msgs::TransformStamped Transform(const std::string& parent, const std::string& child,
                                          const ignition::math::Pose3d& pose) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  transform.transform.translation.x = pose.Pos().X();
  transform.transform.translation.y = pose.Pos().Y();
  transform.transform.translation.z = pose.Pos().Z();
  transform.transform.rotation.x = pose.Rot().X();
  transform.transform.rotation.y = pose.Rot().Y();
  transform.transform.rotation.z = pose.Rot().Z();
  transform.transform.rotation.w = pose.Rot().W();
  return transform;
}

ignition::math::Pose3d InSpace(const PlanarPose& pose) { return {pose.x_m, pose.y_m, 0.0, 0.0, 0.0, pose.yaw_rad}; }

}  // namespace

RobotTopics::RobotTopics(std::string name, const std::optional<ignition::math::Pose3d>& laser, bool is_localised)
    : name_(std::move(name)), is_localised_(is_localised) {
  ros::NodeHandle node = StartedNode();
  const std::string prefix = "/" + name_ + "/";
  odometry_ = node.advertise<nav_msgs::Odometry>(prefix + "odom", kQueue);
  ground_truth_ = node.advertise<nav_msgs::Odometry>(prefix + "base_pose_ground_truth", kQueue);
  contact_ = node.advertise<robotteamsim::Contact>(prefix + "contact", kQueue);
  frames_ = node.advertise<tf2_msgs::TFMessage>("/tf", kQueue);
  fixed_ = {Transform(Frame("base_footprint"), Frame("base_link"), ignition::math::Pose3d::Zero)};
  if (laser) {
    scan_ = node.advertise<sensor_msgs::LaserScan>(prefix + "base_scan", kQueue);
    fixed_.push_back(Transform(Frame("base_link"), Frame("base_laser_link"), *laser));
  }
}

void RobotTopics::Publish(RobotReading reading, const ros::Time& stamp) const {
  nav_msgs::Odometry ground_truth = Odometry("map", reading.ground_truth, reading.motion);
  ground_truth.header.stamp = stamp;
  ground_truth_.publish(ground_truth);
  nav_msgs::Odometry odometry = Odometry(Frame("odom"), reading.odometry, reading.wheels);
  odometry.header.stamp = stamp;
  odometry_.publish(odometry);
  if (reading.scan) {
    reading.scan->header.stamp = stamp;
    reading.scan->header.frame_id = Frame("base_laser_link");
    scan_.publish(*reading.scan);
  }
  robotteamsim::Contact contact;
  contact.header.stamp = stamp;
  contact.header.frame_id = Frame("base_link");
  contact.in_contact = !reading.contact_angles_rad.empty();
  contact.angles_rad = std::move(reading.contact_angles_rad);
  contact_.publish(contact);
  PublishFrames(reading, stamp);
}

nav_msgs::Odometry RobotTopics::Odometry(const std::string& frame, const PlanarPose& pose,
                                         const PlanarTwist& twist) const {
  nav_msgs::Odometry odometry;
  odometry.header.frame_id = frame;
  odometry.child_frame_id = Frame("base_footprint");
  odometry.pose.pose.position.x = pose.x_m;
  odometry.pose.pose.position.y = pose.y_m;
  odometry.pose.pose.orientation = Rotation(pose.yaw_rad);
  odometry.twist.twist.linear.x = twist.forward_mps;
  odometry.twist.twist.linear.y = twist.left_mps;
  odometry.twist.twist.angular.z = twist.turn_radps;
  return odometry;
}

void RobotTopics::PublishFrames(const RobotReading& reading, const ros::Time& stamp) const {
  tf2_msgs::TFMessage message;
  message.transforms = {Transform(Frame("odom"), Frame("base_footprint"), InSpace(reading.odometry))};
  message.transforms.insert(message.transforms.end(), fixed_.begin(), fixed_.end());
  if (is_localised_) {
    const PlanarPose origin = reading.ground_truth * Inverse(reading.odometry);
    message.transforms.push_back(Transform("map", Frame("odom"), InSpace(origin)));
  }
  for (geometry_msgs::TransformStamped& transform : message.transforms) transform.header.stamp = stamp;
  frames_.publish(message);
}

}  // namespace robotteamsim::gazebo_plugins
