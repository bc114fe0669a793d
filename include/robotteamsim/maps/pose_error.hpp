#pragma once

#include <Eigen/Core>
#include <cmath>

namespace robotteamsim::maps {

/// How the error of a pose (x, y, yaw) becomes that of a later one, (dx, dy) farther: an error of the yaw moves it.
inline Eigen::Matrix3d Carrying(double dx, double dy) {
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -dy;
  jacobian(1, 2) = dx;
  return jacobian;
}

/// How the error of a pose (x, y, yaw) is seen in a frame in which its own frame has this yaw.
inline Eigen::Matrix3d Turning(double yaw) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() << std::cos(yaw), -std::sin(yaw), std::sin(yaw), std::cos(yaw);
  return rotation;
}

}  // namespace robotteamsim::maps
