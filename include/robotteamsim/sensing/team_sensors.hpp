#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::sensing {

/// Writes the reported ranges [m] of some robots' lasers in a world, robot by robot.
/// Args: noise: [m], one number per beam, robot by robot; null: none.
void ScanTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots, const double* noise,
              float* ranges);

/// The lasers of one kind and the robots that carry one.
struct TeamLaser {
  std::shared_ptr<const Laser> laser;
  std::vector<int> robots;
};

/// Memory for the scans of one kind of laser and, unless it is null, the noise of its beams, as for ScanTeam.
struct TeamScans {
  float* ranges = nullptr;
  const double* noise = nullptr;
};

/// The reading of one robot without its scan; doubles only, so that a team's readings are rows of an array.
struct RobotReading {
  PoseReading ground_truth;  ///< NaN for an absent robot
  base::Twist twist;
  OdometryReading odometry;
  double in_contact = 0.0;  ///< 1 if the robot touches something
};

/// The sensors of a team.
class TeamSensors {
 public:
  /// Each robot must have one laser.
  TeamSensors(std::shared_ptr<TeamOdometry> odometry, std::vector<TeamLaser> lasers)
      : odometry_(std::move(odometry)), lasers_(std::move(lasers)) {}

  /// Writes the readings after the last step of a world.
  /// Args: odometry_noise, readings: one per robot; scans: one per kind of laser.
  void Read(const world::World& world, const std::vector<Odometry::Noise>& odometry_noise, RobotReading* readings,
            const std::vector<TeamScans>& scans);

  const std::vector<TeamLaser>& lasers() const { return lasers_; }

 private:
  std::shared_ptr<TeamOdometry> odometry_;
  std::vector<TeamLaser> lasers_;
};

}  // namespace robotteamsim::sensing
