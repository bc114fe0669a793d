#include "robotteamsim/control/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"

namespace robotteamsim::control {
namespace {

constexpr double kTau = 6.283185307179586;

constexpr double kDegree = 0.5 * kTau / 180.0;

/// Headings for passing an obstacle are this far apart, up to a right angle to either side.
constexpr double kSidestepDegrees = 10.0;
constexpr int kSidestepsPerSide = 9;

/// By how many headings the first direction of an escape differs between robots of successive ids, and between
/// successive attempts of one robot. Neither has a factor in common with 16, so all directions come first in turn.
constexpr int kHeadingsPerRobot = 5;
constexpr int kHeadingsPerAttempt = 3;

/// Larger than any rounding error [m].
constexpr double kReachMargin = 1e-6;
/// Directions whose room differs by less are equal: the first one is taken [m].
constexpr double kEqualRoom = 1e-9;

base::Point PlaceOf(const base::Pose& pose) { return {pose.x, pose.y}; }

constexpr int kMostRobots = 1'000'000;
constexpr int kMostHeadings = 3600;

NavigatorBody Checked(const NavigatorBody& body) {
  if (body.robot_id < 0 || body.robot_id >= kMostRobots)
    throw std::invalid_argument("robot_id must be from 0 to 999999");
  base::CheckPositive(body.radius, "radius");
  base::CheckPositive(body.max_speed, "max_speed");
  base::CheckNotNegative(body.max_turn, "max_turn");
  return body;
}

NavigatorParameters Checked(const NavigatorParameters& parameters) {
  const NavigatorParameters& p = parameters;
  for (const double value : {p.arrived,
                             p.laser_margin,
                             p.look_ahead,
                             p.longest_path,
                             p.turn_in_place,
                             p.turn_gain,
                             p.braking,
                             p.manoeuvring_speed,
                             p.room_to_turn,
                             p.progress,
                             p.stuck_timeout,
                             p.yield_timeout,
                             p.escape,
                             p.escape_time,
                             p.near_teammate,
                             p.nearest_free_start,
                             p.nearest_free_goal,
                             p.sidestep.left_penalty,
                             p.sidestep.change_penalty,
                             p.sidestep.ahead}) {
    base::CheckNotNegative(value, "each parameter of a navigator");
  }
  if (p.escape_headings < 0 || p.escape_headings > kMostHeadings) {
    throw std::invalid_argument("escape_headings must be from 0 to 3600");
  }
  return parameters;
}

bool IsSeen(double heading, const LaserLayout& laser) {
  return laser.angle_min <= heading && heading <= laser.angle_max;
}

/// Returns the headings for passing an obstacle: every 10 degrees within the laser's field of view.
std::vector<double> SidestepsOf(const LaserLayout& laser) {
  std::vector<double> headings;
  for (int i = -kSidestepsPerSide; i <= kSidestepsPerSide; ++i) {
    const double heading = kSidestepDegrees * i * kDegree;
    if (IsSeen(heading, laser)) headings.push_back(heading);
  }
  if (headings.empty()) headings.push_back(0.0);
  return headings;
}

}  // namespace

Navigator::Navigator(const NavigatorBody& body, bool by_path, const NavigatorParameters& parameters)
    : body_(Checked(body)),
      parameters_(Checked(parameters)),
      by_path_(by_path),
      clearance_(body.laser),
      sidestepper_(clearance_, SidestepsOf(body.laser), parameters.sidestep) {}

base::Twist Navigator::Drive(const std::shared_ptr<const plan::PlanningGrid>& grid, const base::Pose& pose,
                             const Ranges& ranges, const base::Point& goal, double speed, double time,
                             const std::function<Teammates()>& teammates) {
  if (grid == nullptr) throw std::invalid_argument("a navigator needs a grid");
  base::Check(pose, "pose");
  base::Check(goal, "goal");
  base::Check(speed, "speed");
  const base::Point position = PlaceOf(pose);
  if (grid != grid_ || goal.x != goal_.x || goal.y != goal_.y) {
    grid_ = grid;
    goal_ = goal;
    route_ = FindRoute(*grid, position, goal);
    next_ = 0;
  }
  WatchProgress({*grid, pose, ranges, time, teammates});
  if (escape_) return Steer(pose, ranges, *escape_, body_.max_speed, true);
  FollowRoute(*grid, position);
  return Steer(pose, ranges, route_[next_], speed, next_ + 1 == route_.size());
}

std::vector<base::Point> Navigator::FindRoute(const plan::PlanningGrid& grid, const base::Point& position,
                                              const base::Point& goal) const {
  if (!by_path_) return {grid.NearestFree(goal, parameters_.nearest_free_goal).value_or(goal)};
  if (grid.IsLineFree(position, goal)) return {goal};
  const std::optional<base::Point> start = grid.NearestFree(position, parameters_.nearest_free_start);
  if (!start) return {goal};
  std::vector<base::Point> corners = grid.Waypoints(*start, goal, parameters_.longest_path);
  if (corners.size() < 2) return {grid.ReachableTowards(position, goal)};
  corners.erase(corners.begin());
  corners.back() = goal;
  return corners;
}

void Navigator::FollowRoute(const plan::PlanningGrid& grid, const base::Point& position) {
  while (next_ + 1 < route_.size() && grid.IsLineFree(position, route_[next_ + 1])) ++next_;
  if (next_ + 1 < route_.size() && Distance(position, route_[next_]) < parameters_.arrived) ++next_;
}

/// Starts an escape if the robot should move and does not; ends a finished one.
void Navigator::WatchProgress(const Situation& now) {
  const base::Point position = PlaceOf(now.pose);
  const bool moved = Distance(position, anchor_) > parameters_.progress;
  const bool arrived = Distance(position, route_.back()) < 2.0 * parameters_.arrived;
  if (escape_) {
    if (now.time < escape_until_ && Distance(position, *escape_) > parameters_.arrived) return;
    escape_.reset();
    anchor_ = position;
    anchor_time_ = now.time;
  }
  if (moved || arrived) {
    if (moved) num_escapes_ = 0;
    anchor_ = position;
    anchor_time_ = now.time;
    return;
  }
  const double waited = now.time - anchor_time_;
  if (waited <= parameters_.yield_timeout) return;
  const Teammates teammates = now.teammates();
  if (waited <= parameters_.stuck_timeout && !Yields(position, teammates)) return;
  escape_ = FindEscape(now, teammates);
  escape_until_ = now.time + parameters_.escape_time;
  ++num_escapes_;
}

/// Returns whether a teammate of lower id is near.
bool Navigator::Yields(const base::Point& position, const Teammates& teammates) const {
  return std::any_of(teammates.begin(), teammates.end(), [&](const auto& teammate) {
    return teammate.first < body_.robot_id && Distance(position, teammate.second) < parameters_.near_teammate;
  });
}

/// Returns a point nearby with room around it. Different robots, and successive attempts, start with different
/// directions.
base::Point Navigator::FindEscape(const Situation& now, const Teammates& teammates) const {
  const base::Point position = PlaceOf(now.pose);
  const bool is_free = now.grid.IsFree(position);
  // Teammates farther away do not limit the room.
  const double reach = 2.0 * parameters_.escape + body_.radius + kReachMargin;
  std::vector<base::Point> near;
  for (const auto& [robot_id, other] : teammates) {
    if (Distance(position, other) < reach) near.push_back(other);
  }
  base::Point best = position;
  double best_room = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < parameters_.escape_headings; ++i) {
    const int side =
        (i + kHeadingsPerRobot * body_.robot_id + kHeadingsPerAttempt * num_escapes_) % parameters_.escape_headings;
    const double heading = kTau * side / parameters_.escape_headings;
    const base::Point point{position.x + parameters_.escape * std::cos(heading),
                            position.y + parameters_.escape * std::sin(heading)};
    if (!(is_free ? now.grid.IsLineFree(position, point) : now.grid.IsFree(point))) continue;
    const double room = RoomAt(now, point, heading, near);
    if (room > best_room + kEqualRoom) {
      best = point;
      best_room = room;
    }
  }
  return best;
}

/// Returns the room between a point and the teammates, and on the path to it as far as the laser sees.
double Navigator::RoomAt(const Situation& now, const base::Point& point, double heading,
                         const std::vector<base::Point>& near) const {
  double room = parameters_.escape;
  for (const base::Point& other : near) room = std::min(room, Distance(point, other) - body_.radius);
  const double relative = base::NormaliseAngle(heading - now.pose.yaw);
  if (!IsSeen(relative, body_.laser)) return room;
  return std::min(
      room, clearance_.FreeDistance(now.ranges, relative, body_.radius + parameters_.laser_margin, parameters_.escape));
}

/// Returns the command that leads towards a visible point, around obstacles.
base::Twist Navigator::Steer(const base::Pose& pose, const Ranges& ranges, const base::Point& point, double speed,
                             bool is_last) {
  const double dx = point.x - pose.x, dy = point.y - pose.y;
  const double distance = base::Hypot(dx, dy);
  if (distance < parameters_.arrived) return {};
  const double wanted = base::NormaliseAngle(std::atan2(dy, dx) - pose.yaw);
  const double needed = std::min(distance, parameters_.look_ahead);
  const auto [heading, free] = sidestepper_.Find(ranges, wanted, body_.radius + parameters_.laser_margin, needed);
  const double turn = std::clamp(parameters_.turn_gain * heading, -body_.max_turn, body_.max_turn);
  if (std::abs(heading) > parameters_.turn_in_place) return {ManoeuvringSpeed(ranges, speed), 0.0, turn};
  const double room = is_last ? std::min(free, distance) : free;
  const double fastest = std::min({speed, body_.max_speed, std::sqrt(2.0 * parameters_.braking * std::max(0.0, room))});
  return {fastest * std::cos(heading), 0.0, turn};
}

/// Returns the speed during a large turn: 0, except for a car, which must drive; backwards if there is no room ahead.
double Navigator::ManoeuvringSpeed(const Ranges& ranges, double speed) const {
  if (!body_.is_car) return 0.0;
  const double free =
      clearance_.FreeDistance(ranges, 0.0, body_.radius + parameters_.laser_margin, parameters_.room_to_turn);
  return std::copysign(std::min({speed, body_.max_speed, parameters_.manoeuvring_speed}),
                       free >= parameters_.room_to_turn ? 1.0 : -1.0);
}

}  // namespace robotteamsim::control
