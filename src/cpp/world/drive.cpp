#include "robotteamsim/world/drive.hpp"

#include <algorithm>
#include <cmath>

namespace robotteamsim {
namespace {

constexpr double kPi = 3.14159265358979323846;

double Approached(double now, double wanted, double max, double max_change) {
  const double reachable = std::clamp(wanted, -max, max);
  return std::clamp(reachable, now - max_change, now + max_change);
}

}  // namespace

double NormaliseAngle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped == -kPi ? kPi : wrapped;
}

Pose RelativePose(const Pose& from, const Pose& to) {
  const double cos = std::cos(from.yaw), sin = std::sin(from.yaw);
  const double dx = to.x - from.x, dy = to.y - from.y;
  return {cos * dx + sin * dy, cos * dy - sin * dx, NormaliseAngle(to.yaw - from.yaw)};
}

DriveSpeed ReachedSpeed(const DriveSpeed& now, const Twist& command, const DriveLimits& limits, double dt) {
  return {Approached(now.forward, command.linear_x, limits.max_speed, limits.max_acceleration * dt),
          Approached(now.turn, command.angular_z, limits.max_turn, limits.max_turn_acceleration * dt)};
}

Pose AdvancedPose(const Pose& pose, const DriveSpeed& speed, double dt) {
  const double half_turn = 0.5 * speed.turn * dt;
  const double heading = pose.yaw + half_turn;  // of the chord
  const double chord = speed.forward * dt * (half_turn == 0.0 ? 1.0 : std::sin(half_turn) / half_turn);
  return {pose.x + chord * std::cos(heading), pose.y + chord * std::sin(heading),
          NormaliseAngle(pose.yaw + 2.0 * half_turn)};
}

}  // namespace robotteamsim
