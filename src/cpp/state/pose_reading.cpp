#include "robotteamsim/state/pose_reading.hpp"

#include <cmath>

namespace robotteamsim::state {

PoseReading ReadingOf(const base::Pose& pose) {
  if (std::isnan(pose.x)) return {pose.x, pose.x, pose.x, pose.x};
  return {pose.x, pose.y, std::sin(0.5 * pose.yaw), std::cos(0.5 * pose.yaw)};
}

base::Pose PoseOf(const PoseReading& reading) {
  return {reading.x, reading.y, base::NormaliseAngle(2.0 * std::atan2(reading.qz, reading.qw))};
}

}  // namespace robotteamsim::state
