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
  /// The random numbers of a step: those of `TeamOdometry::Step`, and what is added to the ranges, one row per robot
  /// and one column per beam of the state [m]; empty if no laser has noise.
  struct Noise {
    base::Table<const double> odometry;
    base::Table<const double> ranges_m;
  };

  /// Throws std::invalid_argument if a robot does not exist, or has no laser or several.
  TeamSensors(std::vector<Lasers> lasers, TeamOdometry odometry);

  std::size_t robots() const { return odometry_.size(); }
  /// The beams of the laser that has most.
  std::size_t beams() const { return beams_; }

  /// Lets smoke hide the returns of lasers from now on; null: the air is clear.
  void SetHaze(std::shared_ptr<const hazards::Haze> haze) { haze_ = std::move(haze); }
  /// Restarts the odometry of a robot that has arrived.
  void Restart(int robot) { odometry_.Restart(robot); }

  /// Writes what the bodies measure after a step of the world they live in, into the rows of a mission; once per step.
  /// Throws std::invalid_argument if shapes differ.
  void Read(const world::World& world, const Noise& noise, state::State* state, std::size_t mission);
  /// The same in a world of another kind. Args: ranges_m: true ranges, one table per kind of lasers with a row for each
  /// of its robots.
  void Read(const Motion& motion, const std::vector<base::Table<const double>>& ranges_m, const Noise& noise,
            state::State* state, std::size_t mission);

 private:
  void CheckShape(const Noise& noise, const state::State& state, std::size_t mission) const;
  void Report(const Lasers& lasers, std::size_t index, const double* ranges_m, const base::Pose& pose,
              const Noise& noise, state::State* state, std::size_t first_row) const;

  std::vector<Lasers> lasers_;
  TeamOdometry odometry_;
  std::size_t beams_ = 0;
  std::shared_ptr<const hazards::Haze> haze_;
};

}  // namespace robotteamsim::sensing
