#pragma once

#include <limits>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::simulation {

/// One robot's totals over a trial.
struct RobotTotals {
  double distance_m = 0.0;  ///< length of its true path, without jumps
  int contact_steps = 0;    ///< in which it touched something
  int excluded_steps = 0;   ///< as an excluded robot
  int longest_stay = 0;     ///< most steps within 0.5 m of one place
};

/// Adds up the totals of each robot of a team.
class TeamTotals {
 public:
  /// Args: longest_step_m: a longer step is a jump, such as by a lift.
  TeamTotals(int num_robots, double longest_step_m);

  /// Adds a step.
  /// Args: positions: the true ones in `map` [m]; NaN for a robot that is not there: then nothing counts.
  ///       running: whether the mission runs; staying counts only then.
  /// Throws std::invalid_argument unless there is one of each per robot.
  void AddStep(const std::vector<base::Point>& positions, const std::vector<bool>& in_contact,
               const std::vector<bool>& excluded, bool running);

  /// The sums so far, of each robot.
  std::vector<RobotTotals> Totals() const;

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  struct Log {
    RobotTotals sums;
    base::Point last{kNaN, kNaN};    // NaN: it was not there
    base::Point anchor{kNaN, kNaN};  // centre of its current stay
    int stay = 0;                    // number of its steps
  };

  void Add(const base::Point& at, bool in_contact, bool is_excluded, bool is_running, Log* log);

  std::vector<Log> logs_;
  double longest_step_m_;
};

}  // namespace robotteamsim::simulation
