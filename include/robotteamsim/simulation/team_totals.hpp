#pragma once

#include <limits>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::simulation {

/// One robot's totals over a trial.
struct RobotTotals {
  double distance = 0.0;   ///< length of its true path [m]
  int contact_steps = 0;   ///< in which it touched something
  int excluded_steps = 0;  ///< as an excluded robot
  int longest_stay = 0;    ///< most steps within 0.5 m of one place
};

/// Adds up the totals of each robot of a team.
class TeamTotals {
 public:
  explicit TeamTotals(int num_robots);

  /// Adds one step of a robot. Staying counts only while the mission runs.
  /// Args: at: its true position in `map` [m]; NaN if it is not there: then nothing counts.
  void Add(int robot, const base::Point& at, bool in_contact, bool is_excluded, bool is_running);

  int num_robots() const { return static_cast<int>(logs_.size()); }
  /// The sums so far.
  const RobotTotals& of(int robot) const { return logs_[robot].sums; }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  struct Log {
    RobotTotals sums;
    base::Point last{kNaN, kNaN};    // NaN: it was not there
    base::Point anchor{kNaN, kNaN};  // centre of its current stay
    int stay = 0;                    // number of its steps
  };

  std::vector<Log> logs_;
};

}  // namespace robotteamsim::simulation
