#include "robotteamsim/control/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

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

/// A robot whose escape ends so many times farther away than it began was carried elsewhere, such as by a lift.
constexpr double kCarriedAway = 4.0;

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
  base::CheckPositive(body.radius_m, "radius_m");
  base::CheckPositive(body.max_speed_mps, "max_speed_mps");
  base::CheckNotNegative(body.max_turn_radps, "max_turn_radps");
  return body;
}

NavigatorParameters Checked(const NavigatorParameters& parameters) {
  std::apply([&](const auto&... field) { (base::CheckNotNegative(parameters.*field.member, field.name), ...); },
             kNavigatorFields);
  if (parameters.escape_headings > kMostHeadings) {
    throw std::invalid_argument("escape_headings must be from 0 to 3600");
  }
  return parameters;
}

bool IsSeen(double heading_rad, const LaserLayout& laser) {
  return laser.angle_min_rad <= heading_rad && heading_rad <= laser.angle_max_rad;
}

/// Returns the headings for passing an obstacle: every 10 degrees within the laser's field of view.
std::vector<double> SidestepsOf(const LaserLayout& laser) {
  std::vector<double> headings_rad;
  for (int i = -kSidestepsPerSide; i <= kSidestepsPerSide; ++i) {
    const double heading_rad = kSidestepDegrees * i * kDegree;
    if (IsSeen(heading_rad, laser)) headings_rad.push_back(heading_rad);
  }
  if (headings_rad.empty()) headings_rad.push_back(0.0);
  return headings_rad;
}

}  // namespace

Navigator::Navigator(const NavigatorBody& body, bool by_path, const NavigatorParameters& parameters)
    : body_(Checked(body)),
      parameters_(Checked(parameters)),
      by_path_(by_path),
      clearance_(body.laser),
      sidestepper_(
          clearance_, SidestepsOf(body.laser),
          {parameters.sidestep_left_penalty, parameters.sidestep_change_penalty, parameters.sidestep_ahead_rad}) {}

base::Twist Navigator::Drive(const std::shared_ptr<const plan::PlanningGrid>& grid, const base::Pose& pose,
                             const Ranges& ranges, const base::Point& goal, double speed_mps, double time_s,
                             const std::function<Teammates()>& teammates) {
  if (grid == nullptr) throw std::invalid_argument("a navigator needs a grid");
  base::Check(pose, "pose");
  base::Check(goal, "goal");
  base::Check(speed_mps, "speed_mps");
  const base::Point position = PlaceOf(pose);
  if (grid != grid_ || goal.x != goal_.x || goal.y != goal_.y) {
    grid_ = grid;
    goal_ = goal;
    route_ = FindRoute(*grid, position, goal);
    next_ = 0;
  }
  WatchProgress({*grid, pose, ranges, time_s, teammates});
  if (escape_) return Steer(pose, ranges, *escape_, body_.max_speed_mps, true);
  FollowRoute(*grid, position);
  return Steer(pose, ranges, route_[next_], speed_mps, next_ + 1 == route_.size());
}

std::vector<base::Point> Navigator::FindRoute(const plan::PlanningGrid& grid, const base::Point& position,
                                              const base::Point& goal) const {
  if (!by_path_) return {grid.NearestFree(goal, parameters_.nearest_free_goal_m).value_or(goal)};
  if (grid.IsLineFree(position, goal)) return {goal};
  const std::optional<base::Point> start = grid.NearestFree(position, parameters_.nearest_free_start_m);
  if (!start) return {goal};
  std::vector<base::Point> corners = grid.Waypoints(*start, goal, parameters_.longest_path_m);
  if (corners.size() < 2) return {grid.ReachableTowards(position, goal)};
  corners.erase(corners.begin());
  corners.back() = goal;
  return corners;
}

void Navigator::FollowRoute(const plan::PlanningGrid& grid, const base::Point& position) {
  while (next_ + 1 < route_.size() && grid.IsLineFree(position, route_[next_ + 1])) ++next_;
  if (next_ + 1 < route_.size() && Distance(position, route_[next_]) < parameters_.arrived_m) ++next_;
}

/// Starts an escape if the robot should move and does not; ends a finished one.
void Navigator::WatchProgress(const Situation& now) {
  const base::Point position = PlaceOf(now.pose);
  const bool moved = Distance(position, anchor_) > parameters_.progress_m;
  const bool arrived_m = Distance(position, route_.back()) < 2.0 * parameters_.arrived_m;
  if (escape_) {
    const double left_m = Distance(position, *escape_);
    const bool was_carried = left_m > kCarriedAway * parameters_.escape_m;
    if (now.time_s < escape_until_s_ && left_m > parameters_.arrived_m && !was_carried) return;
    escape_.reset();
    anchor_ = position;
    anchor_time_s_ = now.time_s;
  }
  if (moved || arrived_m) {
    if (moved) num_escapes_ = 0;
    anchor_ = position;
    anchor_time_s_ = now.time_s;
    return;
  }
  const double waited = now.time_s - anchor_time_s_;
  if (waited <= parameters_.yield_timeout_s) return;
  const Teammates teammates = now.teammates();
  if (waited <= parameters_.stuck_timeout_s && !Yields(position, teammates)) return;
  escape_ = FindEscape(now, teammates);
  escape_until_s_ = now.time_s + parameters_.escape_time_s;
  ++num_escapes_;
}

/// Returns whether a teammate of lower id is near.
bool Navigator::Yields(const base::Point& position, const Teammates& teammates) const {
  return std::any_of(teammates.begin(), teammates.end(), [&](const auto& teammate) {
    return teammate.first < body_.robot_id && Distance(position, teammate.second) < parameters_.near_teammate_m;
  });
}

/// Returns a point nearby with room around it. Different robots, and successive attempts, start with different
/// directions.
base::Point Navigator::FindEscape(const Situation& now, const Teammates& teammates) const {
  const base::Point position = PlaceOf(now.pose);
  const bool is_free = now.grid.IsFree(position);
  // Teammates farther away do not limit the room.
  const double reach = 2.0 * parameters_.escape_m + body_.radius_m + kReachMargin;
  std::vector<base::Point> near;
  for (const auto& [robot_id, other] : teammates) {
    if (Distance(position, other) < reach) near.push_back(other);
  }
  base::Point best = position;
  double best_room = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < parameters_.escape_headings; ++i) {
    const int side =
        (i + kHeadingsPerRobot * body_.robot_id + kHeadingsPerAttempt * num_escapes_) % parameters_.escape_headings;
    const double heading_rad = kTau * side / parameters_.escape_headings;
    const base::Point point{position.x + parameters_.escape_m * std::cos(heading_rad),
                            position.y + parameters_.escape_m * std::sin(heading_rad)};
    if (!(is_free ? now.grid.IsLineFree(position, point) : now.grid.IsFree(point))) continue;
    const double room = RoomAt(now, point, heading_rad, near);
    if (room > best_room + kEqualRoom) {
      best = point;
      best_room = room;
    }
  }
  return best;
}

/// Returns the room between a point and the teammates, and on the path to it as far as the laser sees.
double Navigator::RoomAt(const Situation& now, const base::Point& point, double heading_rad,
                         const std::vector<base::Point>& near) const {
  double room = parameters_.escape_m;
  for (const base::Point& other : near) room = std::min(room, Distance(point, other) - body_.radius_m);
  const double relative = base::NormaliseAngle(heading_rad - now.pose.yaw);
  if (!IsSeen(relative, body_.laser)) return room;
  return std::min(room, clearance_.FreeDistance(now.ranges, relative, body_.radius_m + parameters_.laser_margin_m,
                                                parameters_.escape_m));
}

/// Returns the command that leads towards a visible point, around obstacles.
base::Twist Navigator::Steer(const base::Pose& pose, const Ranges& ranges, const base::Point& point, double speed_mps,
                             bool is_last) {
  const double dx = point.x - pose.x, dy = point.y - pose.y;
  const double distance = base::Hypot(dx, dy);
  if (distance < parameters_.arrived_m) return {};
  const double wanted_rad = base::NormaliseAngle(std::atan2(dy, dx) - pose.yaw);
  const double needed_m = std::min(distance, parameters_.look_ahead_m);
  const auto [heading_rad, free] =
      sidestepper_.Find(ranges, wanted_rad, body_.radius_m + parameters_.laser_margin_m, needed_m);
  const double turn =
      std::clamp(parameters_.turn_gain_per_s * heading_rad, -body_.max_turn_radps, body_.max_turn_radps);
  if (std::abs(heading_rad) > parameters_.turn_in_place_rad) return {ManoeuvringSpeed(ranges, speed_mps), 0.0, turn};
  const double room = is_last ? std::min(free, distance) : free;
  const double fastest =
      std::min({speed_mps, body_.max_speed_mps, std::sqrt(2.0 * parameters_.braking_mps2 * std::max(0.0, room))});
  return {fastest * std::cos(heading_rad), 0.0, turn};
}

/// Returns the speed during a large turn: 0, except for a car, which must drive; backwards if there is no room ahead.
double Navigator::ManoeuvringSpeed(const Ranges& ranges, double speed_mps) const {
  if (!body_.is_car) return 0.0;
  const double free =
      clearance_.FreeDistance(ranges, 0.0, body_.radius_m + parameters_.laser_margin_m, parameters_.room_to_turn_m);
  return std::copysign(std::min({speed_mps, body_.max_speed_mps, parameters_.manoeuvring_mps}),
                       free >= parameters_.room_to_turn_m ? 1.0 : -1.0);
}

}  // namespace robotteamsim::control
