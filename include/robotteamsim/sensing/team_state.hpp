#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/sensing/odometry.hpp"
#include "robotteamsim/sensing/pose_reading.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::sensing {

/// What the odometry of a team measures; one entry per robot.
struct OdometryState {
  std::vector<PoseReading> pose;                ///< in `odom`
  std::vector<base::Twist> twist;               ///< that the wheels measured, in base_link
  std::vector<PoseCovariance> pose_covariance;  ///< of the pose
  std::vector<TwistVariances> twist_variances;  ///< of the twist
};

/// The state of a team after a step; one entry per robot. An absent robot's true pose is NaN, and its other entries
/// mean nothing.
struct TeamState {
  std::vector<PoseReading> true_pose;   ///< in `map`
  std::vector<base::Twist> true_twist;  ///< the mean velocity in the step, in base_link
  OdometryState odometry;
  std::vector<std::uint8_t> contact;  ///< whether it touches something: 0 or 1

  std::size_t size() const { return true_pose.size(); }

  /// The true positions in `map`.
  std::vector<base::Point> positions() const;
};

/// Throws std::invalid_argument unless all arrays have the same length.
void Check(const OdometryState& odometry);
void Check(const TeamState& state);

}  // namespace robotteamsim::sensing
