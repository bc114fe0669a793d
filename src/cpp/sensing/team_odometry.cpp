#include "robotteamsim/sensing/team_odometry.hpp"

#include <stdexcept>

namespace robotteamsim::sensing {

TeamOdometry::TeamOdometry(const std::vector<OdometryModel>& models, double step, const std::vector<bool>& omni) {
  if (omni.size() != models.size()) throw std::invalid_argument("omni must have one value per robot");
  for (std::size_t i = 0; i < models.size(); ++i) first_.emplace_back(models[i], step, omni[i]);
  team_ = first_;
}

std::vector<OdometryReading> TeamOdometry::Step(const std::vector<base::Pose>& motions,
                                                const std::vector<base::Twist>& twists,
                                                const std::vector<Odometry::Noise>& noise) {
  if (motions.size() != team_.size() || twists.size() != team_.size() || noise.size() != team_.size()) {
    throw std::invalid_argument("motions, twists and noise must have one row of three numbers per robot");
  }
  std::vector<OdometryReading> readings;
  readings.reserve(team_.size());
  for (std::size_t i = 0; i < team_.size(); ++i) {
    Odometry& odometry = team_[i];
    odometry.Step(motions[i], twists[i], noise[i]);
    readings.push_back({ReadingOf(odometry.pose()), odometry.twist(), odometry.covariance(), odometry.speed_variance(),
                        odometry.sideways_variance(), odometry.turn_variance()});
  }
  return readings;
}

}  // namespace robotteamsim::sensing
