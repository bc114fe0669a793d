#pragma once

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "arrays.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::bindings {

/// One row per robot. Pose and Twist are three doubles each.
template <typename Row>
pybind11::array_t<double> ToArray(const std::vector<Row>& rows) {
  static_assert(sizeof(Row) == 3 * sizeof(double));
  auto array = NewArray<double>({static_cast<pybind11::ssize_t>(rows.size()), pybind11::ssize_t{3}});
  if (!rows.empty()) std::memcpy(array.mutable_data(), rows.data(), rows.size() * sizeof(Row));
  return array;
}

/// One row per robot: x, y, qz, qw; NaN of one that is not there.
inline pybind11::array_t<double> PoseReadings(const World& world) {
  auto rows = NewArray<double>({static_cast<pybind11::ssize_t>(world.poses().size()), pybind11::ssize_t{4}});
  double* row = rows.mutable_data();
  for (const Pose& pose : world.poses()) {
    if (pose.x == pose.x) {
      WritePoseReading(pose, row);
    } else {
      std::fill(row, row + 4, pose.x);
    }
    row += 4;
  }
  return rows;
}

/// One row per robot: x, y.
inline pybind11::array_t<double> Positions(const World& world) {
  auto rows = NewArray<double>({static_cast<pybind11::ssize_t>(world.poses().size()), pybind11::ssize_t{2}});
  double* row = rows.mutable_data();
  for (const Pose& pose : world.poses()) {
    *row++ = pose.x;
    *row++ = pose.y;
  }
  return rows;
}

inline pybind11::array_t<bool> ToFlags(const std::vector<bool>& values) {
  auto flags = NewArray<bool>({static_cast<pybind11::ssize_t>(values.size())});
  std::copy(values.begin(), values.end(), flags.mutable_data());
  return flags;
}

/// The angles of contact of those robots that touch something, by their ids.
inline pybind11::dict ContactAngles(const World& world) {
  pybind11::dict angles;
  for (int i = 0; i < static_cast<int>(world.in_contact().size()); ++i) {
    if (world.in_contact()[i]) angles[pybind11::int_(i)] = pybind11::tuple(pybind11::cast(world.contact_angles(i)));
  }
  return angles;
}

}  // namespace robotteamsim::bindings
