#pragma once

namespace robotteamsim::base {

/// A point in the map frame [m].
struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// A straight segment from a to b in the map frame [m].
struct Segment {
  Point a;
  Point b;
};

/// A rigid transform of the plane: base_link in the map frame, or a robot's motion within one step [m, m, rad].
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

/// Returns the same direction as an angle in (-pi, pi].
double NormaliseAngle(double angle_rad);

/// Returns the motion from `from` to `to`, in the frame of `from`.
Pose RelativePose(const Pose& from, const Pose& to);

/// Returns the pose that a motion in the frame of `from` leads to: the inverse of RelativePose.
Pose Composed(const Pose& from, const Pose& motion);

}  // namespace robotteamsim::base
