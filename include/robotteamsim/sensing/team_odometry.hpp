#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/table.hpp"
#include "robotteamsim/sensing/odometry.hpp"
#include "robotteamsim/state/state.hpp"

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

  /// Adds one step of all robots, and writes their readings from a row of the state on.
  /// Args: motions: in the frames of their beginnings; twists: mean velocities, in base_link; noise: three standard
  /// normal numbers per robot, see `OdometryNoise`.
  /// Throws std::invalid_argument if there is not one row of each per robot.
  void Step(const std::vector<base::Pose>& motions, const std::vector<base::Twist>& twists,
            const base::Table<const double>& noise, state::State* state, std::size_t first_row);

 private:
  std::vector<Odometry> first_;
  std::vector<Odometry> team_;
};

}  // namespace robotteamsim::sensing
