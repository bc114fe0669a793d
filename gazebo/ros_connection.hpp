// roscpp inside the process of gzserver, and Gazebo's time.
#pragma once

#include <ros/node_handle.h>
#include <ros/time.h>

#include <cstdint>
#include <gazebo/physics/PhysicsTypes.hh>

namespace robotteamsim::gazebo_plugins {

// Returns a handle to the node /gazebo of this process; the first plugin that calls this starts it.
ros::NodeHandle StartedNode();

// Simulated time [ns].
std::int64_t TimeNs(const gazebo::physics::WorldPtr& world);

ros::Time Stamp(std::int64_t time_ns);

// Is due once per period of simulated time, at its multiples; the first time after one period.
class Period {
 public:
  explicit Period(double period_s);

  // Returns whether a multiple of the period has been reached since the last call. Time may jump back between calls.
  bool IsDue(std::int64_t time_ns);

 private:
  std::int64_t period_ns_;
  std::int64_t last_ = 0;
};

}  // namespace robotteamsim::gazebo_plugins
