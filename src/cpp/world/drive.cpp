#include "robotteamsim/world/drive.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::world {
namespace {

constexpr double kPi = 3.14159265358979323846;

double Approached(double now, double wanted, double max, double max_change) {
  const double reachable = std::clamp(wanted, -max, max);
  return std::clamp(reachable, now - max_change, now + max_change);
}

// A velocity in the plane approaches the commanded one along the straight line between them.
DriveSpeed ReachedOmniSpeed(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits, double dt_s) {
  const double wanted = std::hypot(command.linear_x, command.linear_y);
  const double share = wanted > limits.max_speed_mps ? limits.max_speed_mps / wanted : 1.0;
  const double forward = share * command.linear_x - now.forward_mps, left = share * command.linear_y - now.left_mps;
  const double change = std::hypot(forward, left), max_change = limits.max_acceleration_mps2 * dt_s;
  const double part = change > max_change ? max_change / change : 1.0;
  DriveSpeed speed = now;
  speed.forward_mps = now.forward_mps + part * forward;
  speed.left_mps = now.left_mps + part * left;
  speed.turn_radps =
      Approached(now.turn_radps, command.angular_z, limits.max_turn_radps, limits.max_turn_acceleration_radps2 * dt_s);
  return speed;
}

DriveSpeed ReachedCarSpeed(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits, double dt_s) {
  DriveSpeed speed = now;
  speed.forward_mps =
      Approached(now.forward_mps, command.linear_x, limits.max_speed_mps, limits.max_acceleration_mps2 * dt_s);
  if (speed.forward_mps != 0.0) {
    const double wanted = std::atan(limits.wheelbase_m * command.angular_z / speed.forward_mps);
    speed.steering_rad =
        Approached(now.steering_rad, wanted, limits.max_steering_rad, limits.max_steering_rate_radps * dt_s);
  }
  speed.turn_radps = CarTurn(speed.forward_mps, speed.steering_rad, limits);
  return speed;
}

}  // namespace

DriveKind DriveKindOf(const std::string& name) {
  if (name == "differential") return DriveKind::kDifferential;
  if (name == "omni") return DriveKind::kOmni;
  if (name == "car") return DriveKind::kCar;
  throw std::invalid_argument("a drive must be differential, omni or car, got " + name);
}

void CheckDrive(const DriveLimits& limits) {
  const bool is_car = limits.kind == DriveKind::kCar;
  const double shared[] = {limits.max_speed_mps, limits.max_acceleration_mps2};
  const double turning[] = {limits.max_turn_radps, limits.max_turn_acceleration_radps2};
  const double steering[] = {limits.wheelbase_m, limits.max_steering_rad, limits.max_steering_rate_radps};
  const bool fine = std::all_of(std::begin(shared), std::end(shared), base::IsPositive) &&
                    (is_car ? std::all_of(std::begin(steering), std::end(steering), base::IsPositive)
                            : std::all_of(std::begin(turning), std::end(turning), base::IsPositive));
  if (!fine) throw std::invalid_argument("sizes and limits of a robot must be > 0");
  if (is_car && !(limits.max_steering_rad < 0.5 * kPi)) {
    throw std::invalid_argument("max_steering_rad must be below a right angle, got " +
                                std::to_string(limits.max_steering_rad));
  }
}

double SpeedBound(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits) {
  const bool is_omni = limits.kind == DriveKind::kOmni;
  const double wanted = is_omni ? std::hypot(command.linear_x, command.linear_y) : std::abs(command.linear_x);
  const double current = is_omni ? std::hypot(now.forward_mps, now.left_mps) : std::abs(now.forward_mps);
  return std::max(std::min(wanted, limits.max_speed_mps), current);
}

DriveSpeed ReachedSpeed(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits, double dt_s) {
  if (limits.kind == DriveKind::kOmni) return ReachedOmniSpeed(now, command, limits, dt_s);
  if (limits.kind == DriveKind::kCar) return ReachedCarSpeed(now, command, limits, dt_s);
  return {
      Approached(now.forward_mps, command.linear_x, limits.max_speed_mps, limits.max_acceleration_mps2 * dt_s),
      Approached(now.turn_radps, command.angular_z, limits.max_turn_radps, limits.max_turn_acceleration_radps2 * dt_s)};
}

void CheckCommands(const std::vector<base::Twist>& commands, std::size_t robots) {
  if (commands.size() != robots) {
    throw std::invalid_argument("expected " + std::to_string(robots) + " twists, got " +
                                std::to_string(commands.size()));
  }
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const base::Twist& twist = commands[i];
    if (!std::isfinite(twist.linear_x) || !std::isfinite(twist.linear_y) || !std::isfinite(twist.angular_z)) {
      throw std::invalid_argument("robot_" + std::to_string(i) + ": twist must be finite, got (" +
                                  std::to_string(twist.linear_x) + ", " + std::to_string(twist.linear_y) + ", " +
                                  std::to_string(twist.angular_z) + ")");
    }
  }
}

std::vector<DriveSpeed> ReachedSpeeds(const std::vector<DriveSpeed>& now, const std::vector<base::Twist>& commands,
                                      const std::vector<DriveLimits>& limits, double dt_s) {
  if (now.size() != limits.size()) throw std::invalid_argument("there must be one speed per drive");
  CheckCommands(commands, limits.size());
  base::CheckPositive(dt_s, "dt_s");
  std::vector<DriveSpeed> reached;
  reached.reserve(now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    CheckDrive(limits[i]);
    for (const double value : {now[i].forward_mps, now[i].turn_radps, now[i].left_mps, now[i].steering_rad}) {
      base::Check(value, "the speed of a drive");
    }
    reached.push_back(ReachedSpeed(now[i], commands[i], limits[i], dt_s));
  }
  return reached;
}

double CarTurn(double forward_mps, double steering_rad, const DriveLimits& limits) {
  return forward_mps * std::tan(steering_rad) / limits.wheelbase_m;
}

base::Pose AdvancedPose(const base::Pose& pose, const DriveSpeed& speed, double dt_s) {
  const double half_turn = 0.5 * speed.turn_radps * dt_s;
  const double heading = pose.yaw + half_turn;  // of the chord
  const double shrink = half_turn == 0.0 ? 1.0 : std::sin(half_turn) / half_turn;
  const double chord = speed.forward_mps * dt_s * shrink, aside = speed.left_mps * dt_s * shrink;
  const double cos = std::cos(heading), sin = std::sin(heading);
  return {pose.x + (chord * cos - aside * sin), pose.y + (chord * sin + aside * cos),
          base::NormaliseAngle(pose.yaw + 2.0 * half_turn)};
}

}  // namespace robotteamsim::world
