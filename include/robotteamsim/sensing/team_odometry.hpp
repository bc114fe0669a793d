#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/sensing/odometry.hpp"
#include "robotteamsim/sensing/team_state.hpp"
#include "robotteamsim/world/team_motion.hpp"

namespace robotteamsim::sensing {

/// The odometry of all robots of a team.
class TeamOdometry {
 public:
  /// Args: models: of each robot; step_s: length of a step [s]; omni: whether each robot is omnidirectional.
  /// Throws std::invalid_argument if models and omni have different lengths.
  TeamOdometry(const std::vector<OdometryModel>& models, double step_s, const std::vector<bool>& omni);

  std::size_t size() const { return team_.size(); }

  /// Restarts a robot's odometry at its origin.
  void Restart(int robot) { team_.at(robot) = first_.at(robot); }

  /// Adds one step of all robots. Args: motions: in the frames of their beginnings; twists: mean velocities, in
  /// base_link.
  /// Throws std::invalid_argument if there is not one of each per robot.
  OdometryState Step(const std::vector<base::Pose>& motions, const std::vector<base::Twist>& twists,
                     const std::vector<Odometry::Noise>& noise);

  /// Adds one step of all robots, and returns the team's state after it.
  /// Throws std::invalid_argument if there is not one entry of each per robot.
  TeamState Read(world::TeamMotion team, const std::vector<Odometry::Noise>& noise);

 private:
  std::vector<Odometry> first_;
  std::vector<Odometry> team_;
};

}  // namespace robotteamsim::sensing
