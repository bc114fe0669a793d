#pragma once

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::world {

/// How a robot moves.
enum class DriveKind {
  kDifferential,  ///< turns on the spot, never moves sideways
  kOmni,          ///< moves in any direction and turns at the same time
  kCar,           ///< a bicycle with base_link in the middle of its rear axle: turns only while it drives
};

/// What a drive can do; all that its kind has is above 0. The limits of an omnidirectional drive hold for the length of
/// its velocity in the plane and of that velocity's change.
struct DriveLimits {
  double max_speed = 0.7;              ///< forward and backward; of kOmni in any direction [m/s]
  double max_turn = 2.0;               ///< not of kCar [rad/s]
  double max_acceleration = 2.0;       ///< [m/s^2]
  double max_turn_acceleration = 8.0;  ///< not of kCar [rad/s^2]
  DriveKind kind = DriveKind::kDifferential;
  double wheelbase = 0.0;          ///< of kCar: between the axles [m]
  double max_steering = 0.0;       ///< of kCar: to either side, below a right angle [rad]
  double max_steering_rate = 0.0;  ///< of kCar [rad/s]
};

/// How fast a drive runs.
struct DriveSpeed {
  double forward = 0.0;   ///< [m/s]
  double turn = 0.0;      ///< counter-clockwise [rad/s]
  double left = 0.0;      ///< of kOmni [m/s]
  double steering = 0.0;  ///< of kCar: of the front wheel, counter-clockwise [rad]
};

/// Throws std::invalid_argument unless a drive of its kind can have these limits.
void CheckDrive(const DriveLimits& limits);

/// Returns the greatest speed that a drive can have in any direction from now on under a command [m/s].
double SpeedBound(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits);

/// Returns the speed after `dt` [s] of a drive that runs at `now` and shall run as `command` says. Speeds beyond the
/// limits are out of its reach, and so is a sideways velocity unless it is omnidirectional. A car steers for the turn
/// that is wanted at the speed that it then has; standing, it leaves its wheel as it is.
DriveSpeed ReachedSpeed(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits, double dt);

/// Returns how fast a car turns that drives at a speed [m/s] with its front wheel as it is [rad/s].
double CarTurn(double forward, double steering, const DriveLimits& limits);

/// Returns the pose after `dt` [s] at constant speed: a circular arc, without rounding it to a polygon.
base::Pose AdvancedPose(const base::Pose& pose, const DriveSpeed& speed, double dt);

}  // namespace robotteamsim::world
