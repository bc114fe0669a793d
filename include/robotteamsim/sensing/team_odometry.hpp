#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/sensing/odometry.hpp"
#include "robotteamsim/sensing/pose_reading.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::sensing {

/// The reading of a robot's odometry.
struct OdometryReading {
  PoseReading pose;                ///< in `odom`
  base::Twist twist;               ///< that the wheels measured, in base_link
  PoseCovariance covariance;       ///< of the pose
  double forward_variance = 0.0;   ///< of the twist [m^2/s^2]
  double sideways_variance = 0.0;  ///< [m^2/s^2]
  double turn_variance = 0.0;      ///< [rad^2/s^2]
};

/// The odometry of all robots of a team.
class TeamOdometry {
 public:
  /// Args: models: of each robot; step: length of a step [s]; omni: whether each robot is omnidirectional.
  /// Throws std::invalid_argument if models and omni have different lengths.
  TeamOdometry(const std::vector<OdometryModel>& models, double step, const std::vector<bool>& omni);

  std::size_t size() const { return team_.size(); }

  /// Restarts a robot's odometry at its origin.
  void Restart(int robot) { team_.at(robot) = first_.at(robot); }

  /// Adds one step of all robots. Args: motions: in the frames of their beginnings; twists: mean velocities, in
  /// base_link.
  /// Throws std::invalid_argument if there is not one of each per robot.
  std::vector<OdometryReading> Step(const std::vector<base::Pose>& motions, const std::vector<base::Twist>& twists,
                                    const std::vector<Odometry::Noise>& noise);

  /// The same for the last step of a world.
  std::vector<OdometryReading> Follow(const world::World& world, const std::vector<Odometry::Noise>& noise) {
    return Step(world.motions(), world.twists(), noise);
  }

 private:
  std::vector<Odometry> first_;
  std::vector<Odometry> team_;
};

}  // namespace robotteamsim::sensing
