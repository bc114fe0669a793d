#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>

#include <array>
#include <cstddef>
#include <utility>

#include "robotteamsim/base/geometry.hpp"

namespace nanobind::detail {

/// A point is a pair of floats in Python.
template <>
struct type_caster<robotteamsim::base::Point> {
  using Pair = std::pair<double, double>;
  using PairCaster = make_caster<Pair>;
  NB_TYPE_CASTER(robotteamsim::base::Point, PairCaster::Name)

  bool from_python(handle source, uint32_t flags, cleanup_list* cleanup) noexcept {
    PairCaster caster;
    if (!caster.from_python(source, flags, cleanup)) return false;
    const Pair pair = caster.operator Pair();
    value = {pair.first, pair.second};
    return true;
  }

  static handle from_cpp(const robotteamsim::base::Point& point, rv_policy policy, cleanup_list* cleanup) noexcept {
    return PairCaster::from_cpp(Pair(point.x, point.y), policy, cleanup);
  }
};

/// Reads three attributes of a Python object, whose names are interned strings.
inline bool ReadAttributes(handle source, const std::array<PyObject*, 3>& names, std::array<double, 3>* numbers) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const object number = steal(PyObject_GetAttr(source.ptr(), names[i]));
    (*numbers)[i] = number.is_valid() ? PyFloat_AsDouble(number.ptr()) : -1.0;
    if ((*numbers)[i] == -1.0 && PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      return false;
    }
  }
  return true;
}

/// A pose is a `robotteamsim.geometry.Pose`, read by the names of its attributes.
template <>
struct type_caster<robotteamsim::base::Pose> {
  NB_TYPE_CASTER(robotteamsim::base::Pose, const_name("robotteamsim.geometry.Pose"))

  bool from_python(handle source, uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    static const std::array<PyObject*, 3> names{PyUnicode_InternFromString("x_m"), PyUnicode_InternFromString("y_m"),
                                                PyUnicode_InternFromString("yaw_rad")};
    std::array<double, 3> numbers;
    if (!ReadAttributes(source, names, &numbers)) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  }
};

/// A twist is a `robotteamsim.geometry.Twist`, read by the names of its attributes.
template <>
struct type_caster<robotteamsim::base::Twist> {
  NB_TYPE_CASTER(robotteamsim::base::Twist, const_name("robotteamsim.geometry.Twist"))

  static handle from_cpp(const robotteamsim::base::Twist& twist, rv_policy /*policy*/, cleanup_list* /*cleanup*/) {
    // Kept for as long as the interpreter runs.
    static const handle twist_class = object(module_::import_("robotteamsim.geometry").attr("Twist")).release();
    return twist_class(twist.linear_x, twist.linear_y, twist.angular_z).release();
  }

  bool from_python(handle source, uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    static const std::array<PyObject*, 3> names{PyUnicode_InternFromString("linear_x_mps"),
                                                PyUnicode_InternFromString("linear_y_mps"),
                                                PyUnicode_InternFromString("angular_z_radps")};
    std::array<double, 3> numbers;
    if (!ReadAttributes(source, names, &numbers)) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  }
};

}  // namespace nanobind::detail
