#include "robotteamsim/sensing/team_odometry.hpp"

#include <stdexcept>
#include <utility>

namespace robotteamsim::sensing {

TeamOdometry::TeamOdometry(const std::vector<OdometryModel>& models, double step_s, const std::vector<bool>& omni) {
  if (omni.size() != models.size()) throw std::invalid_argument("omni must have one value per robot");
  for (std::size_t i = 0; i < models.size(); ++i) first_.emplace_back(models[i], step_s, omni[i]);
  team_ = first_;
}

OdometryState TeamOdometry::Step(const std::vector<base::Pose>& motions, const std::vector<base::Twist>& twists,
                                 const std::vector<Odometry::Noise>& noise) {
  if (motions.size() != team_.size() || twists.size() != team_.size() || noise.size() != team_.size()) {
    throw std::invalid_argument("motions, twists and noise must have one row of three numbers per robot");
  }
  OdometryState state;
  for (std::size_t i = 0; i < team_.size(); ++i) {
    Odometry& odometry = team_[i];
    odometry.Step(motions[i], twists[i], noise[i]);
    state.pose.push_back(ReadingOf(odometry.pose()));
    state.twist.push_back(odometry.twist());
    state.pose_covariance.push_back(odometry.covariance());
    state.twist_variances.push_back(odometry.twist_variances());
  }
  return state;
}

TeamState TeamOdometry::Read(world::TeamMotion team, const std::vector<Odometry::Noise>& noise) {
  TeamState state;
  for (const base::Pose& pose : team.poses) state.true_pose.push_back(ReadingOf(pose));
  state.odometry = Step(team.motions, team.twists, noise);
  state.true_twist = std::move(team.twists);
  state.contact = std::move(team.in_contact);
  Check(state);
  return state;
}

}  // namespace robotteamsim::sensing
