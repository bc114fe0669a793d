#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::sensing {

/// Reported ranges of lasers [m], one row per robot.
using Scans = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the reported ranges of some robots' lasers in a world.
/// Args: noise: [m], one number per beam, robot by robot; null: none.
Scans ScanTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots, const double* noise);

/// The lasers of one kind and the robots that carry one.
struct TeamLaser {
  std::shared_ptr<const Laser> laser;
  std::vector<int> robots;
};

/// The readings of all robots after a step.
struct TeamReadings {
  std::vector<PoseReading> ground_truth;  ///< NaN for a robot that is not there
  std::vector<base::Point> positions;     ///< x, y of the ground truth
  std::vector<base::Twist> twists;
  std::vector<OdometryReading> odometry;
  std::vector<Scans> scans;  ///< one matrix per kind of laser, in the order of its robots
  Eigen::Array<bool, Eigen::Dynamic, 1> in_contact;
};

/// The sensors of a team.
class TeamSensors {
 public:
  /// Each robot must have one laser.
  TeamSensors(std::shared_ptr<TeamOdometry> odometry, std::vector<TeamLaser> lasers)
      : odometry_(std::move(odometry)), lasers_(std::move(lasers)) {}

  /// Returns the readings after the last step of a world.
  /// Args: odometry_noise: one per robot; laser_noise: as for ScanTeam, for each kind of laser.
  TeamReadings Read(const world::World& world, const std::vector<Odometry::Noise>& odometry_noise,
                    const std::vector<const double*>& laser_noise);

  const std::vector<TeamLaser>& lasers() const { return lasers_; }

 private:
  std::shared_ptr<TeamOdometry> odometry_;
  std::vector<TeamLaser> lasers_;
};

}  // namespace robotteamsim::sensing
