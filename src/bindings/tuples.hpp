#pragma once

#include <pybind11/pybind11.h>

#include <initializer_list>
#include <stdexcept>
#include <utility>

namespace robotteamsim::bindings {

/// Makes tuples of a class that adds no data to `tuple`, as a NamedTuple: many times faster than a call of the class.
class TupleClass {
 public:
  /// Throws std::invalid_argument where the class is none of tuples.
  explicit TupleClass(pybind11::type type) : type_(std::move(type)) {
    if (!PyType_IsSubtype(cls(), &PyTuple_Type)) throw std::invalid_argument("wanted a class of tuples");
  }

  /// A tuple of these new references, which it takes over.
  pybind11::object Of(std::initializer_list<PyObject*> items) const {
    auto tuple = pybind11::reinterpret_steal<pybind11::object>(
        cls()->tp_alloc(cls(), static_cast<pybind11::ssize_t>(items.size())));
    if (!tuple) throw pybind11::error_already_set();
    pybind11::ssize_t i = 0;
    for (PyObject* const item : items) PyTuple_SET_ITEM(tuple.ptr(), i++, item);
    return tuple;
  }

  /// A tuple of `count` numbers.
  pybind11::object OfNumbers(const double* numbers, int count) const {
    auto tuple = pybind11::reinterpret_steal<pybind11::object>(cls()->tp_alloc(cls(), count));
    if (!tuple) throw pybind11::error_already_set();
    for (int i = 0; i < count; ++i) PyTuple_SET_ITEM(tuple.ptr(), i, PyFloat_FromDouble(numbers[i]));
    return tuple;
  }

 private:
  PyTypeObject* cls() const { return reinterpret_cast<PyTypeObject*>(type_.ptr()); }

  pybind11::type type_;
};

}  // namespace robotteamsim::bindings
