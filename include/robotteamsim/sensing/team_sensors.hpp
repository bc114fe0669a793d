#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/table.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::sensing {

/// Writes the reported ranges [m] of some robots' lasers in a world: one row per robot, one column per beam.
/// Args: noise: added to the ranges [m]; empty: none.
/// Throws std::invalid_argument if a table has another shape.
void ScanTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots,
              const base::Table<const double>& noise, const base::Table<float>& ranges);

/// Returns the nearest return of each robot's laser as it is reported [m], as by a sonar.
/// Args: noise: added to it [m], one number per robot; empty: none.
/// Throws std::invalid_argument if there is noise of another number of robots.
std::vector<float> ScanNearest(const Laser& laser, const world::World& world, const std::vector<int>& robots,
                               const std::vector<double>& noise);

/// Removes the returns that smoke hides from some robots' lasers, as Laser::Dim does.
/// Args: ranges: as ScanTeam reports them.  Throws std::invalid_argument if they have another shape.
void DimTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots, const hazards::Haze& haze,
             const base::Table<float>& ranges);

/// The lasers of one kind and the robots that carry one.
struct TeamLaser {
  std::shared_ptr<const Laser> laser;
  std::vector<int> robots;
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
  /// Args: odometry_noise, readings: one per robot; laser_noise, ranges: of each kind of laser, as for ScanTeam; no
  ///       laser_noise at all: none has any.
  /// Throws std::invalid_argument if a shape is wrong; nothing is written then.
  void Read(const world::World& world, const std::vector<Odometry::Noise>& odometry_noise,
            const std::vector<base::Table<const double>>& laser_noise, RobotReading* readings,
            const std::vector<base::Table<float>>& ranges);

 private:
  std::shared_ptr<TeamOdometry> odometry_;
  std::vector<TeamLaser> lasers_;
};

}  // namespace robotteamsim::sensing
