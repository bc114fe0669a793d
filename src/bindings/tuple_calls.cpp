// Tuples with names, made and read in every step by every robot: decisions and poses.
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

// with_item(tuple, index, item): a tuple of the same class with one other item.
PyObject* WithItem(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  if (num_args != 3 || !PyTuple_Check(args[0]) || !PyLong_Check(args[1])) {
    return Refuse("wanted a tuple, an index, and an item");
  }
  const Py_ssize_t size = PyTuple_GET_SIZE(args[0]), index = PyLong_AsSsize_t(args[1]);
  if (index < 0 || index >= size) return Refuse("the tuple has no item of this index");
  PyObject* const made = NewTuple(reinterpret_cast<PyObject*>(Py_TYPE(args[0])), size);
  for (Py_ssize_t i = 0; made != nullptr && i < size; ++i) {
    PyObject* const item = i == index ? args[2] : PyTuple_GET_ITEM(args[0], i);
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

bool IsFinite(PyObject* number) { return PyFloat_CheckExact(number) && std::isfinite(PyFloat_AS_DOUBLE(number)); }

bool IsWhole(PyObject* number, long least, long most) {
  if (!PyLong_CheckExact(number)) return false;
  int overflow = 0;
  const long value = PyLong_AsLongAndOverflow(number, &overflow);
  return overflow == 0 && least <= value && value <= most;
}

bool AreFinite(PyObject* tuple, Py_ssize_t count) {
  if (PyTuple_GET_SIZE(tuple) != count) return false;
  for (Py_ssize_t i = 0; i < count; ++i) {
    if (!IsFinite(PyTuple_GET_ITEM(tuple, i))) return false;
  }
  return true;
}

// Whether a decision is of its class, a named tuple of 8, with a twist of its own and a tuple of whatever it sends, and
// holds plain and finite values in their ranges. Most are and do, and this is asked of every robot in every step.
bool IsPlainDecision(PyObject* told, PyObject* decision_class, PyObject* twist_class) {
  if (Py_TYPE(told) != reinterpret_cast<PyTypeObject*>(decision_class) || PyTuple_GET_SIZE(told) != 8) {
    return false;
  }
  PyObject* const twist = PyTuple_GET_ITEM(told, 0);
  if (Py_TYPE(twist) != reinterpret_cast<PyTypeObject*>(twist_class) || !AreFinite(twist, 3)) return false;
  PyObject *const outbox = PyTuple_GET_ITEM(told, 1), *const goal = PyTuple_GET_ITEM(told, 3);
  if (!PyTuple_CheckExact(outbox)) return false;
  if (goal != Py_None && !(PyTuple_CheckExact(goal) && AreFinite(goal, 2))) return false;
  constexpr long kLargest = 2147483647;  // messages of ROS have 32 bits for it
  return PyBool_Check(PyTuple_GET_ITEM(told, 2)) && PyFloat_CheckExact(PyTuple_GET_ITEM(told, 4)) &&
         IsWhole(PyTuple_GET_ITEM(told, 5), 0, kLargest) && IsWhole(PyTuple_GET_ITEM(told, 6), -1, kLargest) &&
         PyUnicode_CheckExact(PyTuple_GET_ITEM(told, 7));
}

// is_plain_decision(decision, class of decisions, class of twists)
PyObject* AskIfPlain(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  if (num_args != 3) return Refuse("wanted a decision, the class of decisions, and that of twists");
  return PyBool_FromLong(IsPlainDecision(args[0], args[1], args[2]) ? 1 : 0);
}

template <typename Function>
PyMethodDef MethodOf(const char* name, Function* function) {
  return {name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(function)), METH_FASTCALL, nullptr};
}

}  // namespace

void BindTupleCalls(py::module_& m) {
  static std::array<PyMethodDef, 5> functions{MethodOf("as_tuple", &AsTuple), MethodOf("with_item", &WithItem),
                                              MethodOf("to_pose", &ToPose), MethodOf("is_plain_decision", &AskIfPlain),
                                              PyMethodDef{nullptr, nullptr, 0, nullptr}};
  if (PyModule_AddFunctions(m.ptr(), functions.data()) != 0) throw py::error_already_set();
}

}  // namespace robotteamsim::bindings
