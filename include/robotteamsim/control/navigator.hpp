#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/control/clearance.hpp"
#include "robotteamsim/plan/grid.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::control {

/// How a navigator drives; the scenario's `control.navigator` has the defaults.
struct NavigatorParameters {
  double arrived = 0.0;        ///< a robot this near to a point is there [m]
  double laser_margin = 0.0;   ///< kept between the body and the laser's returns; below the map's margin, or planned
                               ///< paths would be refused [m]
  double look_ahead = 0.0;     ///< how far ahead a heading must be free [m]
  double longest_path = 0.0;   ///< the longest path that is searched for [m]
  double turn_in_place = 0.0;  ///< the robot turns on the spot to headings beyond this [rad]
  double turn_gain = 0.0;      ///< yaw rate per angle to the heading [1/s]
  double braking = 0.0;        ///< planned deceleration before obstacles [m/s^2]
  double manoeuvring_speed = 0.0;  ///< of a car that must turn far [m/s]
  double room_to_turn = 0.0;       ///< with less room ahead, a car that must turn far drives back [m]

  double progress = 0.0;            ///< a robot that moves less is stuck [m]
  double stuck_timeout = 0.0;       ///< a robot that is stuck for longer escapes [s]
  double yield_timeout = 0.0;       ///< the same beside a teammate of lower id, which has the right of way [s]
  double escape = 0.0;              ///< length of an escape [m]
  double escape_time = 0.0;         ///< an escape ends after this time [s]
  int escape_headings = 0;          ///< number of directions tried around the robot
  double near_teammate = 0.0;       ///< a teammate this near is beside the robot [m]
  double nearest_free_start = 0.0;  ///< how far from a blocked position a path may begin [m]
  double nearest_free_goal = 0.0;   ///< how far from a blocked goal a straight drive may end [m]
  SidestepParameters sidestep;
};

/// The robot that a navigator drives.
struct NavigatorBody {
  int robot_id = 0;
  double radius = 0.2;  ///< [m]
  LaserLayout laser;
  double max_speed = 0.7;  ///< [m/s]
  double max_turn = 2.0;   ///< [rad/s]
  bool is_car = false;     ///< cannot turn on the spot
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
    double time;                                  ///< of the simulation [s]
    const std::function<Teammates()>& teammates;  ///< called only if the robot is stuck
  };

  /// Args: by_path: whether it plans paths on the map; else it drives straight towards its goals.
  Navigator(const NavigatorBody& body, bool by_path, const NavigatorParameters& parameters);

  /// Returns the command of this step. A goal [m, map] inside an obstacle is replaced by the nearest free point that
  /// can be reached. `speed` [m/s] is not exceeded. The path is planned again if the grid or the goal has changed.
  base::Twist Drive(const std::shared_ptr<const plan::PlanningGrid>& grid, const base::Pose& pose, const Ranges& ranges,
                    const base::Point& goal, double speed, double time, const std::function<Teammates()>& teammates);

 private:
  std::vector<base::Point> FindRoute(const plan::PlanningGrid& grid, const base::Point& position,
                                     const base::Point& goal) const;
  void FollowRoute(const plan::PlanningGrid& grid, const base::Point& position);
  void WatchProgress(const Situation& now);
  bool Yields(const base::Point& position, const Teammates& teammates) const;
  base::Point FindEscape(const Situation& now, const Teammates& teammates) const;
  double RoomAt(const Situation& now, const base::Point& point, double heading,
                const std::vector<base::Point>& near) const;
  base::Twist Steer(const base::Pose& pose, const Ranges& ranges, const base::Point& point, double speed, bool is_last);
  double ManoeuvringSpeed(const Ranges& ranges, double speed) const;

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
  double anchor_time_ = 0.0;
  std::optional<base::Point> escape_;
  double escape_until_ = 0.0;
  int num_escapes_ = 0;
};

}  // namespace robotteamsim::control
