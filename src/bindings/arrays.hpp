#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::bindings {

/// A NumPy array in C order; -1 is an extent of any length. Arguments of another type or order are converted.
template <typename Value, nanobind::ssize_t... extents>
using Array =
    nanobind::ndarray<Value, nanobind::numpy, nanobind::shape<extents...>, nanobind::c_contig, nanobind::device::cpu>;

using Points = Array<const double, -1, 2>;
using Triples = Array<const double, -1, 3>;

/// A new array to be filled in through `data()`; its memory is freed with the last NumPy array that shows it.
template <typename Value, nanobind::ssize_t... extents>
Array<Value, extents...> NewArray(const std::array<std::size_t, sizeof...(extents)>& shape) {
  std::size_t size = 1;
  for (const std::size_t extent : shape) size *= extent;
  auto* const data = new Value[size];
  const nanobind::capsule owner(data, [](void* values) noexcept { delete[] static_cast<Value*>(values); });
  return Array<Value, extents...>(data, shape.size(), shape.data(), owner);
}

/// One row of `count` numbers per record; records of doubles only.
template <nanobind::ssize_t count, typename Record>
Array<double, -1, count> RowsOf(const std::vector<Record>& records) {
  static_assert(sizeof(Record) == count * sizeof(double));
  auto rows = NewArray<double, -1, count>({records.size(), static_cast<std::size_t>(count)});
  auto* const to = reinterpret_cast<Record*>(rows.data());
  for (std::size_t i = 0; i < records.size(); ++i) to[i] = records[i];
  return rows;
}

/// The points of an array with one per row.
inline std::vector<base::Point> PointsOf(const Points& rows) {
  const auto* const points = reinterpret_cast<const base::Point*>(rows.data());
  return {points, points + rows.shape(0)};
}

inline Array<bool, -1> FlagsOf(const std::vector<bool>& values) {
  auto flags = NewArray<bool, -1>({values.size()});
  for (std::size_t i = 0; i < values.size(); ++i) flags.data()[i] = values[i];
  return flags;
}

}  // namespace robotteamsim::bindings
