#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>

#include "robotteamsim/plan/types.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::bindings {

/// Reads as many numbers as a sequence of Python must have; false, without an error of Python's, where it is another.
template <std::size_t count>
bool ReadNumbers(pybind11::handle source, std::array<double, count>* numbers) {
  // PySequence_Fast would copy a NamedTuple, as most that come here are.
  const auto sequence = PyTuple_Check(source.ptr())
                            ? pybind11::reinterpret_borrow<pybind11::object>(source)
                            : pybind11::reinterpret_steal<pybind11::object>(PySequence_Fast(source.ptr(), ""));
  bool is_good = sequence && PySequence_Fast_GET_SIZE(sequence.ptr()) == static_cast<Py_ssize_t>(count);
  for (std::size_t i = 0; i < count && is_good; ++i) {
    PyObject* const number = PySequence_Fast_GET_ITEM(sequence.ptr(), static_cast<Py_ssize_t>(i));
    (*numbers)[i] = PyFloat_CheckExact(number) ? PyFloat_AS_DOUBLE(number) : PyFloat_AsDouble(number);
    is_good = (*numbers)[i] != -1.0 || PyErr_Occurred() == nullptr;
  }
  if (!is_good) PyErr_Clear();
  return is_good;
}

}  // namespace robotteamsim::bindings

namespace pybind11::detail {

/// A point is (x, y) in Python.
template <>
struct type_caster<robotteamsim::Point> {
  PYBIND11_TYPE_CASTER(robotteamsim::Point, const_name("tuple[float, float]"));

  bool load(handle source, bool) {
    std::array<double, 2> numbers;
    if (!robotteamsim::bindings::ReadNumbers(source, &numbers)) return false;
    value = {numbers[0], numbers[1]};
    return true;
  }

  static handle cast(const robotteamsim::Point& point, return_value_policy, handle) {
    PyObject* const pair = PyTuple_New(2);
    if (pair == nullptr) throw error_already_set();
    PyTuple_SET_ITEM(pair, 0, PyFloat_FromDouble(point.x));
    PyTuple_SET_ITEM(pair, 1, PyFloat_FromDouble(point.y));
    return pair;
  }
};

/// A pose is (x, y, yaw) in Python.
template <>
struct type_caster<robotteamsim::Pose> {
  PYBIND11_TYPE_CASTER(robotteamsim::Pose, const_name("tuple[float, float, float]"));

  bool load(handle source, bool) {
    std::array<double, 3> numbers;
    if (!robotteamsim::bindings::ReadNumbers(source, &numbers)) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  }
};

}  // namespace pybind11::detail
