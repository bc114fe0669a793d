#include "robotteamsim/sensing/team_state.hpp"

#include <stdexcept>

namespace robotteamsim::sensing {

std::vector<base::Point> TeamState::positions() const {
  std::vector<base::Point> positions;
  positions.reserve(size());
  for (const PoseReading& pose : true_pose) positions.push_back({pose.x, pose.y});
  return positions;
}

void Check(const OdometryState& odometry) {
  const std::size_t robots = odometry.pose.size();
  if (odometry.twist.size() != robots || odometry.pose_covariance.size() != robots ||
      odometry.twist_variances.size() != robots) {
    throw std::invalid_argument("each array of the odometry must have one row per robot");
  }
}

void Check(const TeamState& state) {
  Check(state.odometry);
  const std::size_t robots = state.size();
  if (state.true_twist.size() != robots || state.odometry.pose.size() != robots || state.contact.size() != robots) {
    throw std::invalid_argument("each array of a team's state must have one row per robot");
  }
}

}  // namespace robotteamsim::sensing
