#pragma once

// How C++ types become Python's and back. Every binding includes this header: a function that returns a type of the
// standard library or of Eigen compiles without its caster, and then fails when it is called.
#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include "robotteamsim/base/geometry.hpp"

namespace nanobind::detail {

namespace base = robotteamsim::base;

/// The base of a type caster for a struct that is a tuple of these members in Python.
template <typename Struct, auto... members>
struct TupleCaster {
  using Tuple = std::tuple<std::decay_t<decltype(std::declval<Struct>().*members)>...>;
  using Caster = make_caster<Tuple>;
  NB_TYPE_CASTER(Struct, Caster::Name)

  bool from_python(handle source, uint32_t flags, cleanup_list* cleanup) noexcept {
    Caster caster;
    if (!caster.from_python(source, flags, cleanup)) return false;
    std::tie(value.*members...) = caster.operator Tuple();
    return true;
  }

  static handle from_cpp(const Struct& record, rv_policy policy, cleanup_list* cleanup) noexcept {
    return Caster::from_cpp(Tuple(record.*members...), policy, cleanup);
  }
};

/// A point is a pair of floats in Python.
template <>
struct type_caster<base::Point> : TupleCaster<base::Point, &base::Point::x, &base::Point::y> {};

/// Reads three doubles from attributes of a Python object, whose names are interned strings.
template <typename Record>
bool ReadAttributes(handle source, const std::array<PyObject*, 3>& names, Record* record) {
  std::array<double, 3> numbers;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const object number = steal(PyObject_GetAttr(source.ptr(), names[i]));
    numbers[i] = number.is_valid() ? PyFloat_AsDouble(number.ptr()) : -1.0;
    if (numbers[i] == -1.0 && PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      return false;
    }
  }
  *record = {numbers[0], numbers[1], numbers[2]};
  return true;
}

/// A pose is a `robotteamsim.geometry.Pose`, read by the names of its attributes.
template <>
struct type_caster<base::Pose> {
  NB_TYPE_CASTER(base::Pose, const_name("robotteamsim.geometry.Pose"))

  static handle from_cpp(const base::Pose& pose, rv_policy /*policy*/, cleanup_list* /*cleanup*/) {
    // Kept for as long as the interpreter runs.
    static const handle pose_class = object(module_::import_("robotteamsim.geometry").attr("Pose")).release();
    return pose_class(pose.x, pose.y, pose.yaw).release();
  }

  bool from_python(handle source, uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    static const std::array<PyObject*, 3> names{PyUnicode_InternFromString("x_m"), PyUnicode_InternFromString("y_m"),
                                                PyUnicode_InternFromString("yaw_rad")};
    return ReadAttributes(source, names, &value);
  }
};

/// A twist is a `robotteamsim.geometry.Twist`, read by the names of its attributes.
template <>
struct type_caster<base::Twist> {
  NB_TYPE_CASTER(base::Twist, const_name("robotteamsim.geometry.Twist"))

  static handle from_cpp(const base::Twist& twist, rv_policy /*policy*/, cleanup_list* /*cleanup*/) {
    // Kept for as long as the interpreter runs.
    static const handle twist_class = object(module_::import_("robotteamsim.geometry").attr("Twist")).release();
    return twist_class(twist.linear_x, twist.linear_y, twist.angular_z).release();
  }

  bool from_python(handle source, uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    static const std::array<PyObject*, 3> names{PyUnicode_InternFromString("linear_x_mps"),
                                                PyUnicode_InternFromString("linear_y_mps"),
                                                PyUnicode_InternFromString("angular_z_radps")};
    return ReadAttributes(source, names, &value);
  }
};

}  // namespace nanobind::detail
