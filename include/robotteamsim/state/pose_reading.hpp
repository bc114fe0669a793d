#pragma once

#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::state {

/// A pose as in ROS messages: position [m] and the unit quaternion (0, 0, qz, qw).
struct PoseReading {
  double x = 0.0;
  double y = 0.0;
  double qz = 0.0;
  double qw = 1.0;
};

/// Returns the reading of a pose; qw >= 0 because the yaw is in (-pi, pi]. NaN for a pose that is NaN.
PoseReading ReadingOf(const base::Pose& pose);

/// Returns the pose of a reading, its yaw in (-pi, pi].
base::Pose PoseOf(const PoseReading& reading);

}  // namespace robotteamsim::state
