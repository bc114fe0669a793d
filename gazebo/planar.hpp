// Poses and velocities in the plane of the floor.
#pragma once

#include <cmath>

namespace robotteamsim::gazebo_plugins {

struct PlanarPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

struct PlanarTwist {
  double forward_mps = 0.0;
  double left_mps = 0.0;
  double turn_radps = 0.0;
};

// a_T_c = a_T_b * b_T_c.
inline PlanarPose operator*(const PlanarPose& a, const PlanarPose& b) {
  const double cos = std::cos(a.yaw_rad);
  const double sin = std::sin(a.yaw_rad);
  return {a.x_m + cos * b.x_m - sin * b.y_m, a.y_m + sin * b.x_m + cos * b.y_m,
          std::remainder(a.yaw_rad + b.yaw_rad, 2.0 * M_PI)};
}

inline PlanarPose Inverse(const PlanarPose& pose) {
  const double cos = std::cos(pose.yaw_rad);
  const double sin = std::sin(pose.yaw_rad);
  return {-cos * pose.x_m - sin * pose.y_m, sin * pose.x_m - cos * pose.y_m, -pose.yaw_rad};
}

// The velocity of the arc that leads there.
inline PlanarTwist Velocity(const PlanarPose& motion, double duration_s) {
  const double half = 0.5 * motion.yaw_rad;
  const double cos = std::cos(half);
  const double sin = std::sin(half);
  const double scale = (std::abs(half) > 1e-9 ? half / sin : 1.0) / duration_s;
  return {scale * (cos * motion.x_m + sin * motion.y_m), scale * (cos * motion.y_m - sin * motion.x_m),
          motion.yaw_rad / duration_s};
}

}  // namespace robotteamsim::gazebo_plugins
