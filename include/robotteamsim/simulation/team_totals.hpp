#pragma once

#include <limits>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::simulation {

/// What one robot did in a trial.
struct RobotTotals {
  double distance = 0.0;   ///< length of its true path [m]
  int contact_steps = 0;   ///< in which it touched something
  int excluded_steps = 0;  ///< as an excluded robot
  int longest_stay = 0;    ///< most steps within 0.5 m of one place
};

/// Adds up what each robot of a team does.
class TeamTotals {
 public:
  explicit TeamTotals(int num_robots) : logs_(num_robots) {}

  /// Takes in what a robot did in one more step. Staying counts only while the mission runs.
  /// Args: at: where it truly is, in `map` [m]; NaN where it is not there, and then nothing of it counts.
  void Add(int robot, const base::Point& at, bool in_contact, bool is_excluded, bool is_running);

  int num_robots() const { return static_cast<int>(logs_.size()); }
  /// The sums so far.
  const RobotTotals& of(int robot) const { return logs_[robot].sums; }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  struct Log {
    RobotTotals sums;
    base::Point last{kNaN, kNaN};    // NaN: it was not there
    base::Point anchor{kNaN, kNaN};  // where it stays
    int stay = 0;                    // steps that it has
  };

  std::vector<Log> logs_;
};

}  // namespace robotteamsim::simulation
