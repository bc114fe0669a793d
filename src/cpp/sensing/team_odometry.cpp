#include "robotteamsim/sensing/team_odometry.hpp"

#include <stdexcept>

namespace robotteamsim::sensing {

TeamOdometry::TeamOdometry(const std::vector<OdometryModel>& models, double step_s, const std::vector<bool>& omni) {
  if (omni.size() != models.size()) throw std::invalid_argument("omni must have one value per robot");
  for (std::size_t i = 0; i < models.size(); ++i) first_.emplace_back(models[i], step_s, omni[i]);
  team_ = first_;
}

void TeamOdometry::Step(const std::vector<base::Pose>& motions, const std::vector<base::Twist>& twists,
                        const base::Table<const double>& noise, state::State* state, std::size_t first_row) {
  const std::size_t robots = team_.size();
  if (motions.size() != robots || twists.size() != robots || !noise.HasShape(robots, 3)) {
    throw std::invalid_argument("motions, twists and noise must have one row of three numbers per robot");
  }
  for (std::size_t i = 0; i < robots; ++i) {
    Odometry& odometry = team_[i];
    const double* const drawn = noise.Row(i);
    odometry.Step(motions[i], twists[i], {drawn[0], drawn[1], drawn[2]});
    const std::size_t row = first_row + i;
    state->odometry_pose[row] = state::ReadingOf(odometry.pose());
    state->odometry_twist[row] = odometry.twist();
    state->odometry_pose_covariance[row] = odometry.covariance();
    state->odometry_twist_variances[row] = odometry.twist_variances();
  }
}

}  // namespace robotteamsim::sensing
