// Floor 0: tuples with names, made and read in every step by every robot.
#include <array>
#include <cmath>
#include <stdexcept>

#include "bindings.hpp"
#include "points.hpp"
#include "tuples.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

// These are plain functions of Python's own interface: what pybind11 does for a call takes longer than they do.

PyObject* Refuse(const char* why) {
  PyErr_SetString(PyExc_TypeError, why);
  return nullptr;
}

bool IsTupleClass(PyObject* type) {
  return PyType_Check(type) && PyType_IsSubtype(reinterpret_cast<PyTypeObject*>(type), &PyTuple_Type);
}

PyObject* NewTuple(PyObject* type, Py_ssize_t size) {
  auto* const cls = reinterpret_cast<PyTypeObject*>(type);
  return cls->tp_alloc(cls, size);
}

// as_tuple(class, items): what tuple.__new__(class, items) makes of a tuple.
PyObject* AsTuple(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  if (num_args != 2 || !IsTupleClass(args[0]) || !PyTuple_CheckExact(args[1])) {
    return Refuse("wanted a class of tuples, and a tuple");
  }
  const Py_ssize_t size = PyTuple_GET_SIZE(args[1]);
  PyObject* const made = NewTuple(args[0], size);
  for (Py_ssize_t i = 0; made != nullptr && i < size; ++i) {
    PyObject* const item = PyTuple_GET_ITEM(args[1], i);
    Py_INCREF(item);
    PyTuple_SET_ITEM(made, i, item);
  }
  return made;
}

// to_pose(reading, class): x, y, qz, qw as x, y, yaw.
PyObject* ToPose(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  std::array<double, 4> numbers;
  if (num_args != 2 || !IsTupleClass(args[1]) || !ReadNumbers(args[0], &numbers)) {
    return Refuse("wanted the reading of a pose, x, y, qz, qw, and the class of poses");
  }
  numbers[2] = NormaliseAngle(2.0 * std::atan2(numbers[2], numbers[3]));
  PyObject* const made = NewTuple(args[1], 3);
  for (Py_ssize_t i = 0; made != nullptr && i < 3; ++i) {
    PyTuple_SET_ITEM(made, i, PyFloat_FromDouble(numbers[static_cast<std::size_t>(i)]));
  }
  return made;
}

template <typename Function>
PyMethodDef MethodOf(const char* name, Function* function) {
  return {name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(function)), METH_FASTCALL, nullptr};
}

}  // namespace

void BindTupleCalls(py::module_& m) {
  static std::array<PyMethodDef, 3> functions{MethodOf("as_tuple", &AsTuple), MethodOf("to_pose", &ToPose),
                                              PyMethodDef{nullptr, nullptr, 0, nullptr}};
  if (PyModule_AddFunctions(m.ptr(), functions.data()) != 0) throw py::error_already_set();
}

}  // namespace robotteamsim::bindings
