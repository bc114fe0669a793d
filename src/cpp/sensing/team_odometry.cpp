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
  const std::size_t robots = team_.size();
  if (motions.size() != robots || twists.size() != robots || noise.size() != robots) {
    throw std::invalid_argument("motions, twists and noise must have one row of three numbers per robot");
  }
  OdometryState state{std::vector<PoseReading>(robots), std::vector<base::Twist>(robots),
                      std::vector<PoseCovariance>(robots), std::vector<TwistVariances>(robots)};
  for (std::size_t i = 0; i < robots; ++i) {
    Odometry& odometry = team_[i];
    odometry.Step(motions[i], twists[i], noise[i]);
    state.pose[i] = ReadingOf(odometry.pose());
    state.twist[i] = odometry.twist();
    state.pose_covariance[i] = odometry.covariance();
    state.twist_variances[i] = odometry.twist_variances();
  }
  return state;
}

TeamState TeamOdometry::Read(world::TeamMotion team, const std::vector<Odometry::Noise>& noise) {
  TeamState state;
  state.true_pose.reserve(team.poses.size());
  for (const base::Pose& pose : team.poses) state.true_pose.push_back(ReadingOf(pose));
  state.odometry = Step(team.motions, team.twists, noise);
  state.true_twist = std::move(team.twists);
  state.contact = std::move(team.in_contact);
  Check(state);
  return state;
}

}  // namespace robotteamsim::sensing
