#include "ros_connection.hpp"

#include <ros/init.h>

#include <cmath>
#include <cstdlib>
#include <gazebo/physics/World.hh>
#include <stdexcept>
#include <string>

namespace robotteamsim::gazebo_plugins {

ros::NodeHandle StartedNode() {
  if (!ros::isInitialized()) {
    // Lines must reach roslaunch immediately.
    setenv("ROSCONSOLE_STDOUT_LINE_BUFFERED", "1", /*overwrite=*/0);
    ros::init(ros::M_string(), "gazebo", ros::init_options::NoSigintHandler);
  }
  return {};
}

std::int64_t TimeNs(const gazebo::physics::WorldPtr& world) {
  const gazebo::common::Time now = world->SimTime();
  return now.sec * std::int64_t{1'000'000'000} + now.nsec;
}

ros::Time Stamp(std::int64_t time_ns) {
  ros::Time stamp;
  stamp.fromNSec(static_cast<std::uint64_t>(time_ns));
  return stamp;
}

Period::Period(double period_s) : period_ns_(std::llround(period_s * 1e9)) {
  if (!(period_ns_ > 0)) throw std::invalid_argument(std::to_string(period_s) + " s; expected a positive period");
}

bool Period::IsDue(std::int64_t time_ns) {
  const std::int64_t count = time_ns / period_ns_;
  const bool is_due = count > last_;
  last_ = count;
  return is_due;
}

}  // namespace robotteamsim::gazebo_plugins
