#pragma once

#include <pybind11/pybind11.h>

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

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
    pybind11::object tuple = Empty(static_cast<pybind11::ssize_t>(items.size()));
    pybind11::ssize_t i = 0;
    for (PyObject* const item : items) PyTuple_SET_ITEM(tuple.ptr(), i++, item);
    return tuple;
  }

  /// A tuple of `count` numbers.
  pybind11::object OfNumbers(const double* numbers, int count) const {
    pybind11::object tuple = Empty(count);
    for (int i = 0; i < count; ++i) PyTuple_SET_ITEM(tuple.ptr(), i, PyFloat_FromDouble(numbers[i]));
    return tuple;
  }

 private:
  pybind11::object Empty(pybind11::ssize_t size) const {
    // Python keeps the memory of tuples of its own for the next ones, but asks for it in PyTuple_New only.
    PyObject* const made = cls() == &PyTuple_Type ? PyTuple_New(size) : cls()->tp_alloc(cls(), size);
    if (made == nullptr) throw pybind11::error_already_set();
    return pybind11::reinterpret_steal<pybind11::object>(made);
  }

  PyTypeObject* cls() const { return reinterpret_cast<PyTypeObject*>(type_.ptr()); }

  pybind11::type type_;
};

/// Makes objects of a class with `__slots__` and nothing else, as a dataclass with slots: a call of the class takes
/// several times as long.
class SlotsClass {
 public:
  /// Args: slots: the names, in the order in which `Of` takes their values.
  SlotsClass(pybind11::type type, const std::vector<std::string>& slots) : type_(std::move(type)) {
    for (const std::string& slot : slots) {
      slots_.push_back(pybind11::reinterpret_steal<pybind11::object>(PyUnicode_InternFromString(slot.c_str())));
    }
  }

  pybind11::object Of(std::initializer_list<pybind11::object> values) const {
    if (values.size() != slots_.size()) throw std::invalid_argument("wanted a value of each slot");
    auto* const cls = reinterpret_cast<PyTypeObject*>(type_.ptr());
    const auto made = pybind11::reinterpret_steal<pybind11::object>(cls->tp_alloc(cls, 0));
    if (!made) throw pybind11::error_already_set();
    auto slot = slots_.begin();
    for (const pybind11::object& value : values) {
      if (PyObject_SetAttr(made.ptr(), (slot++)->ptr(), value.ptr()) != 0) throw pybind11::error_already_set();
    }
    return made;
  }

 private:
  pybind11::type type_;
  std::vector<pybind11::object> slots_;
};

}  // namespace robotteamsim::bindings
