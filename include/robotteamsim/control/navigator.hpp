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

/// How a navigator drives.
struct NavigatorParameters {
  double arrived = 0.05;        ///< a robot this near to a point is there [m]
  double laser_margin = 0.04;   ///< kept between the body and the laser's returns; below the map's margin, or planned
                                ///< paths would be refused [m]
  double look_ahead = 0.5;      ///< how far ahead a heading must be free [m]
  double longest_path = 200.0;  ///< the longest path that is searched for [m]
  double turn_in_place = 0.8;   ///< the robot turns on the spot to headings beyond this [rad]
  double turn_gain = 3.0;       ///< yaw rate per angle to the heading [1/s]
  double braking = 1.0;         ///< planned deceleration before obstacles [m/s^2]
  double manoeuvring_speed = 0.3;  ///< of a car that must turn far [m/s]
  double room_to_turn = 0.4;       ///< with less room ahead, a car that must turn far drives back [m]

  double progress = 0.2;            ///< a robot that moves less is stuck [m]
  double stuck_timeout = 4.0;       ///< a robot that is stuck for longer escapes [s]
  double yield_timeout = 2.0;       ///< the same beside a teammate of lower id, which has the right of way [s]
  double escape = 0.7;              ///< length of an escape [m]
  double escape_time = 3.0;         ///< an escape ends after this time [s]
  int escape_headings = 16;         ///< number of directions tried around the robot
  double near_teammate = 1.0;       ///< a teammate this near is beside the robot [m]
  double nearest_free_start = 1.0;  ///< how far from a blocked position a path may begin [m]
  double nearest_free_goal = 3.0;   ///< how far from a blocked goal a straight drive may end [m]
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
  /// Robots by their ids, and where they were last heard to be [m, map].
  using Teammates = std::vector<std::pair<int, base::Point>>;

  /// What is known in one step.
  struct Situation {
    const plan::PlanningGrid& grid;
    base::Pose pose;
    const Ranges& ranges;
    double time;                                  ///< of the simulation [s]
    const std::function<Teammates()>& teammates;  ///< asked for only where the robot is stuck
  };

  /// Without `by_path` it drives straight towards its goals, as if there were no map.
  Navigator(const NavigatorBody& body, bool by_path, const NavigatorParameters& parameters);

  /// Returns the command of this step. A goal [m, map] inside an obstacle stands for the nearest free point that can be
  /// reached. `speed` [m/s] is not exceeded. With another grid or goal than in the last step the way is looked for
  /// anew.
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
  std::vector<base::Point> route_;  ///< points to drive to, one after the other; at least one after the first step
  std::size_t next_ = 0;            ///< of the route

  /// Where and since when the robot makes no progress.
  base::Point anchor_{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  double anchor_time_ = 0.0;
  std::optional<base::Point> escape_;
  double escape_until_ = 0.0;
  int num_escapes_ = 0;
};

}  // namespace robotteamsim::control
