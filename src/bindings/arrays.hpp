#pragma once

#include <pybind11/numpy.h>

#include <cmath>

#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::bindings {

using Doubles = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Writes a pose as ROS messages carry it: x, y, qz, qw; qw >= 0 as yaw lies in (-pi, pi].
inline void WritePoseReading(const Pose& pose, double* row) {
  row[0] = pose.x;
  row[1] = pose.y;
  row[2] = std::sin(0.5 * pose.yaw);
  row[3] = std::cos(0.5 * pose.yaw);
}

}  // namespace robotteamsim::bindings
