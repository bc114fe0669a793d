#pragma once

#include <pybind11/numpy.h>

#include <cmath>
#include <initializer_list>
#include <utility>

#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::bindings {

/// An argument that is an array of these values, in the order of C; others are converted. As an argument, `array_t`
/// takes several times as long: it first makes an empty array to be filled in.
template <typename Value>
class ArrayOf {
 public:
  /// Whether it could be made of an object of Python.
  bool Load(pybind11::handle source, bool convert) {
    using Array = pybind11::array_t<Value, pybind11::array::c_style | pybind11::array::forcecast>;
    pybind11::object array;
    if (Array::check_(source)) {
      array = pybind11::reinterpret_borrow<pybind11::object>(source);
    } else if (convert) {
      array = Array::ensure(source);
    }
    if (!array) return false;
    const auto view = pybind11::reinterpret_borrow<pybind11::array>(array);
    data_ = static_cast<const Value*>(view.data());
    ndim_ = view.ndim();
    shape_ = view.shape();
    size_ = view.size();
    array_ = std::move(array);
    return true;
  }

  const Value* data() const { return data_; }
  pybind11::ssize_t size() const { return size_; }
  pybind11::ssize_t ndim() const { return ndim_; }
  pybind11::ssize_t shape(int dimension) const { return shape_[dimension]; }

 private:
  pybind11::object array_;  // keeps what the others tell of
  const Value* data_ = nullptr;
  const pybind11::ssize_t* shape_ = nullptr;
  pybind11::ssize_t ndim_ = 0;
  pybind11::ssize_t size_ = 0;
};

using Doubles = ArrayOf<double>;
using Flags = ArrayOf<bool>;

/// A new array to be filled in. The constructor of `array_t` takes several times as long: it makes lists of its own.
template <typename Value>
pybind11::array_t<Value> NewArray(std::initializer_list<pybind11::ssize_t> shape) {
  const auto& numpy = pybind11::detail::npy_api::get();
  PyObject* const array =
      numpy.PyArray_NewFromDescr_(numpy.PyArray_Type_, pybind11::dtype::of<Value>().release().ptr(),
                                  static_cast<int>(shape.size()), shape.begin(), nullptr, nullptr, 0, nullptr);
  if (array == nullptr) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::array_t<Value>>(array);
}

/// Writes a pose as ROS messages carry it: x, y, qz, qw; qw >= 0 as yaw lies in (-pi, pi].
inline void WritePoseReading(const Pose& pose, double* row) {
  row[0] = pose.x;
  row[1] = pose.y;
  row[2] = std::sin(0.5 * pose.yaw);
  row[3] = std::cos(0.5 * pose.yaw);
}

}  // namespace robotteamsim::bindings

namespace pybind11::detail {

template <typename Value>
struct type_caster<robotteamsim::bindings::ArrayOf<Value>> {
  PYBIND11_TYPE_CASTER(robotteamsim::bindings::ArrayOf<Value>, const_name("numpy.ndarray"));

  bool load(handle source, bool convert) { return value.Load(source, convert); }
};

}  // namespace pybind11::detail
