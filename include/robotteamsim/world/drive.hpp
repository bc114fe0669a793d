#pragma once

namespace robotteamsim {

/// A rigid transform of the plane: base_link in the map frame, or a robot's way within one step [m, m, rad].
struct Pose {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;  ///< in (-pi, pi]
};

/// A velocity in base_link: forward and left [m/s], counter-clockwise [rad/s].
struct Twist {
  double linear_x = 0.0;
  double linear_y = 0.0;
  double angular_z = 0.0;
};

/// What a differential drive can do; all above 0.
struct DriveLimits {
  double max_speed = 0.7;              ///< forward and backward [m/s]
  double max_turn = 2.0;               ///< [rad/s]
  double max_acceleration = 2.0;       ///< [m/s^2]
  double max_turn_acceleration = 8.0;  ///< [rad/s^2]
};

/// How fast a drive runs.
struct DriveSpeed {
  double forward = 0.0;  ///< [m/s]
  double turn = 0.0;     ///< counter-clockwise [rad/s]
};

/// Returns the same direction as an angle in (-pi, pi].
double NormaliseAngle(double angle);

/// Returns the way from `from` to `to`, seen from `from`.
Pose RelativePose(const Pose& from, const Pose& to);

/// Returns the speed after `dt` [s] of a drive that runs at `now` and shall run as `command` says. Speeds beyond the
/// limits are out of its reach, and so is a sideways velocity.
DriveSpeed ReachedSpeed(const DriveSpeed& now, const Twist& command, const DriveLimits& limits, double dt);

/// Returns the pose after `dt` [s] at constant speed: a circular arc, without rounding it to a polygon.
Pose AdvancedPose(const Pose& pose, const DriveSpeed& speed, double dt);

}  // namespace robotteamsim
