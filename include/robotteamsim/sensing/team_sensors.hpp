#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "robotteamsim/base/table.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/sensing/range_report.hpp"
#include "robotteamsim/sensing/team_odometry.hpp"
#include "robotteamsim/state/state.hpp"
#include "robotteamsim/world/fan_caster.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::sensing {

/// The lasers of one kind.
struct Lasers {
  world::Fan fan;
  std::shared_ptr<const world::FanCaster> caster;  ///< for robots of a `World`; none where the world is another one
  RangeLimits limits;
  std::vector<int> robots;  ///< that carry one
};

/// The last step of a team in a world of any kind, one entry per robot.
struct Motion {
  std::vector<base::Pose> poses;                    ///< in `map`; NaN for an absent robot
  std::vector<base::Twist> twists;                  ///< mean velocities, in base_link
  std::vector<base::Pose> motions;                  ///< in the frame of the step's beginning
  std::vector<bool> in_contact;                     ///< whether it touched something
  std::vector<std::vector<double>> contact_angles;  ///< as in `State`
};

/// What the bodies of a team measure: odometry, lasers and contacts.
class TeamSensors {
 public:
  /// Throws std::invalid_argument if a robot does not exist, or has no laser or several, or a caster has other beams.
  TeamSensors(std::vector<Lasers> lasers, TeamOdometry odometry);

  std::size_t robots() const { return odometry_.size(); }
  /// The beams of the laser that has most.
  std::size_t beams() const { return beams_; }

  /// Lets smoke hide the returns of lasers from now on; null: the air is clear.
  void SetHaze(std::shared_ptr<const hazards::Haze> haze) { haze_ = std::move(haze); }
  /// Adds the random numbers of the odometry for further steps. Args: noise: standard normal numbers, a row per step of
  /// three per robot, see `OdometryNoise`. Throws std::invalid_argument if it has another shape.
  void AddNoise(const base::Table<const double>& noise);
  /// The number of steps for which there are random numbers.
  std::size_t noise_left() const { return steps_left_; }
  /// Sets what is added to the ranges from now on [m]: one row per robot and one column per beam of the laser that has
  /// most; empty: nothing. Throws std::invalid_argument if it has another shape.
  void SetRangeNoise(const base::Table<const double>& noise_m);
  /// Restarts the odometry of a robot that has arrived. Args: noise: replaces its random numbers that are left, a row
  /// of three per step. Throws std::invalid_argument if there is not one row per step.
  void Restart(int robot, const base::Table<const double>& noise);

  /// Writes what the bodies measure after a step of the world they live in, into the rows of a mission; once per step.
  /// Throws std::invalid_argument if shapes differ, or no random numbers are left.
  void Read(const world::World& world, state::State* state, std::size_t mission);
  /// The same in a world of another kind. Args: ranges_m: true ranges, one table per kind of lasers with a row for each
  /// of its robots.
  void Read(const Motion& motion, const std::vector<base::Table<const double>>& ranges_m, state::State* state,
            std::size_t mission);

 private:
  void CheckShape(const state::State& state, std::size_t mission) const;
  base::Table<const double> NextNoise();
  void Report(const Lasers& lasers, std::size_t robot_id, const double* ranges_m, const base::Pose& pose,
              state::State* state, std::size_t first_row) const;

  std::vector<Lasers> lasers_;
  TeamOdometry odometry_;
  std::size_t beams_ = 0;
  std::shared_ptr<const hazards::Haze> haze_;
  std::vector<double> noise_;  // of the odometry; the steps that are left are at its end
  std::size_t steps_left_ = 0;
  std::vector<double> noise_m_;  // of the ranges
};

}  // namespace robotteamsim::sensing
