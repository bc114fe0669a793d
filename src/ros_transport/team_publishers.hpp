// Publishes the readings of all robots, one step at a time, from arrays with one row per robot.
//
// Each class is created with an example message per robot, as serialized bytes, which has the frames, limits and all
// other constant parts. Nothing is published for absent robots; an empty `present` means that all are present.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <robotteamsim/Contact.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_msgs/TFMessage.h>

#include <cstdint>
#include <string>
#include <vector>

#include "publisher.hpp"

namespace robotteamsim::ros_transport {

// The rows of a matrix, with any distance between them.
struct Rows {
  const double* data;
  std::int64_t stride;  // in numbers

  const double* operator[](std::size_t row) const { return data + static_cast<std::int64_t>(row) * stride; }
};

using Present = std::vector<bool>;

// A topic of each robot, such as /robot_0/odom, /robot_1/odom, ...
template <class Message>
class TeamTopic {
 public:
  // Throws std::invalid_argument if an example is not such a message.
  TeamTopic(const std::vector<std::string>& topics, const std::vector<std::string>& examples, bool latched);

  std::size_t size() const { return messages_.size(); }
  bool IsWanted() const;
  int num_subscribers() const;

 protected:
  Message& message(std::size_t robot_id) { return messages_[robot_id]; }
  void Publish(std::int64_t time_ns, const Present& present);

 private:
  std::vector<Message> messages_;
  std::vector<Publisher> publishers_;
};

class OdometryTopic : public TeamTopic<nav_msgs::Odometry> {
 public:
  using TeamTopic::TeamTopic;
  // poses: x, y [m], and z, w of the quaternion. twists: forward, left [m/s], counter-clockwise [rad/s].
  // Covariances have 36 numbers in each row.
  void PublishStep(std::int64_t time_ns, Rows poses, Rows twists, const Rows* pose_covariances,
                   const Rows* twist_covariances, const Present& present);
};

class ScanTopic : public TeamTopic<sensor_msgs::LaserScan> {
 public:
  using TeamTopic::TeamTopic;
  struct Ranges {
    const float* data;
    std::size_t size;
  };
  void PublishStep(std::int64_t time_ns, const std::vector<Ranges>& ranges_m, const Present& present);
};

class ContactTopic : public TeamTopic<robotteamsim::Contact> {
 public:
  using TeamTopic::TeamTopic;
  void PublishStep(std::int64_t time_ns, const std::vector<bool>& in_contact,
                   const std::vector<std::vector<double>>& angles_rad, const Present& present);
};

// The frames of all robots, in one message on /tf.
class FramesTopic {
 public:
  // examples: a TFMessage per robot, whose first frame moves.
  // origins: empty, or a TFMessage per robot with one more moving frame, published after those of all robots.
  FramesTopic(const std::string& topic, const std::vector<std::string>& examples,
              const std::vector<std::string>& origins);

  std::size_t size() const { return robots_.size(); }
  bool IsWanted() const { return publisher_.IsWanted(); }
  // poses, origins: x, y [m], and z, w of the quaternion.
  void PublishStep(std::int64_t time_ns, Rows poses, const Rows* origins, const Present& present);

 private:
  using Frames = std::vector<geometry_msgs::TransformStamped>;

  std::vector<Frames> robots_;
  std::vector<Frames> origins_;
  Publisher publisher_;
};

}  // namespace robotteamsim::ros_transport
