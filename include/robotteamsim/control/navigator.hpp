#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "robotteamsim/base/fields.hpp"
#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/control/clearance.hpp"
#include "robotteamsim/plan/grid.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::control {

/// How a navigator drives: `control.navigator` of a scenario, which describes each number.
struct NavigatorParameters {
  double arrived_m = 0.0;
  double laser_margin_m = 0.0;
  double look_ahead_m = 0.0;
  double longest_path_m = 0.0;
  double turn_in_place_rad = 0.0;
  double turn_gain_per_s = 0.0;
  double braking_mps2 = 0.0;
  double manoeuvring_mps = 0.0;
  double room_to_turn_m = 0.0;
  double progress_m = 0.0;
  double stuck_timeout_s = 0.0;
  double yield_timeout_s = 0.0;
  double escape_m = 0.0;
  double escape_time_s = 0.0;
  int escape_headings = 0;
  double near_teammate_m = 0.0;
  double nearest_free_start_m = 0.0;
  double nearest_free_goal_m = 0.0;
  double sidestep_left_penalty = 0.0;
  double sidestep_change_penalty = 0.0;
  double sidestep_ahead_rad = 0.0;
};

inline constexpr auto kNavigatorFields =
    std::make_tuple(base::Field{"arrived_m", &NavigatorParameters::arrived_m},
                    base::Field{"laser_margin_m", &NavigatorParameters::laser_margin_m},
                    base::Field{"look_ahead_m", &NavigatorParameters::look_ahead_m},
                    base::Field{"longest_path_m", &NavigatorParameters::longest_path_m},
                    base::Field{"turn_in_place_rad", &NavigatorParameters::turn_in_place_rad},
                    base::Field{"turn_gain_per_s", &NavigatorParameters::turn_gain_per_s},
                    base::Field{"braking_mps2", &NavigatorParameters::braking_mps2},
                    base::Field{"manoeuvring_mps", &NavigatorParameters::manoeuvring_mps},
                    base::Field{"room_to_turn_m", &NavigatorParameters::room_to_turn_m},
                    base::Field{"progress_m", &NavigatorParameters::progress_m},
                    base::Field{"stuck_timeout_s", &NavigatorParameters::stuck_timeout_s},
                    base::Field{"yield_timeout_s", &NavigatorParameters::yield_timeout_s},
                    base::Field{"escape_m", &NavigatorParameters::escape_m},
                    base::Field{"escape_time_s", &NavigatorParameters::escape_time_s},
                    base::Field{"escape_headings", &NavigatorParameters::escape_headings},
                    base::Field{"near_teammate_m", &NavigatorParameters::near_teammate_m},
                    base::Field{"nearest_free_start_m", &NavigatorParameters::nearest_free_start_m},
                    base::Field{"nearest_free_goal_m", &NavigatorParameters::nearest_free_goal_m},
                    base::Field{"sidestep_left_penalty", &NavigatorParameters::sidestep_left_penalty},
                    base::Field{"sidestep_change_penalty", &NavigatorParameters::sidestep_change_penalty},
                    base::Field{"sidestep_ahead_rad", &NavigatorParameters::sidestep_ahead_rad});

/// The robot that a navigator drives.
struct NavigatorBody {
  int robot_id = 0;
  double radius_m = 0.2;
  LaserLayout laser;
  double max_speed_mps = 0.7;
  double max_turn_radps = 2.0;
  bool is_car = false;  ///< cannot turn on the spot
};

/// Drives one robot to a goal: along the known map, around what the laser sees, and out of jams.
class Navigator {
 public:
  /// Robot ids and the last reported positions [m, map].
  using Teammates = std::vector<std::pair<int, base::Point>>;

  /// The inputs of one step.
  struct Situation {
    const plan::PlanningGrid& grid;
    base::Pose pose;
    const Ranges& ranges;
    double time_s;                                ///< of the simulation
    const std::function<Teammates()>& teammates;  ///< called only if the robot is stuck
  };

  /// Args: by_path: whether it plans paths on the map; else it drives straight towards its goals.
  Navigator(const NavigatorBody& body, bool by_path, const NavigatorParameters& parameters);

  int robot_id() const { return body_.robot_id; }

  /// Returns the command of this step. A goal [m, map] inside an obstacle is replaced by the nearest free point that
  /// can be reached. `speed_mps` is not exceeded. The path is planned again if the grid or the goal has changed.
  base::Twist Drive(const std::shared_ptr<const plan::PlanningGrid>& grid, const base::Pose& pose, const Ranges& ranges,
                    const base::Point& goal, double speed_mps, double time_s,
                    const std::function<Teammates()>& teammates);

 private:
  std::vector<base::Point> FindRoute(const plan::PlanningGrid& grid, const base::Point& position,
                                     const base::Point& goal) const;
  void FollowRoute(const plan::PlanningGrid& grid, const base::Point& position);
  void WatchProgress(const Situation& now);
  bool Yields(const base::Point& position, const Teammates& teammates) const;
  base::Point FindEscape(const Situation& now, const Teammates& teammates) const;
  double RoomAt(const Situation& now, const base::Point& point, double heading_rad,
                const std::vector<base::Point>& near) const;
  base::Twist Steer(const base::Pose& pose, const Ranges& ranges, const base::Point& point, double speed_mps,
                    bool is_last);
  double ManoeuvringSpeed(const Ranges& ranges, double speed_mps) const;

  NavigatorBody body_;
  NavigatorParameters parameters_;
  bool by_path_;
  ScanClearance clearance_;
  Sidestepper sidestepper_;

  std::shared_ptr<const plan::PlanningGrid> grid_;
  base::Point goal_;
  std::vector<base::Point> route_;  ///< points to drive to in turn; not empty after the first step
  std::size_t next_ = 0;            ///< index in the route

  /// The position and time since which the robot has made no progress.
  base::Point anchor_{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double anchor_time_s_ = 0.0;
  std::optional<base::Point> escape_;
  double escape_until_s_ = 0.0;
  int num_escapes_ = 0;
};

}  // namespace robotteamsim::control
