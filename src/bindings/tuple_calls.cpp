// Tuples with names, made and read in every step by every robot: decisions and poses.
#include <algorithm>
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

// Where in a tuple an index of Python is; -1, without an error of Python's, where the tuple has no item of it.
Py_ssize_t PlaceIn(PyObject* tuple, PyObject* index) {
  const Py_ssize_t place = PyLong_AsSsize_t(index);
  if (place == -1) PyErr_Clear();
  return place < PyTuple_GET_SIZE(tuple) ? std::max<Py_ssize_t>(place, -1) : -1;
}

// with_items(tuple, index, item, index, item, ...): a tuple of the same class with some other items.
PyObject* WithItems(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  bool fits = num_args % 2 == 1 && PyTuple_Check(args[0]);
  for (Py_ssize_t arg = 1; fits && arg < num_args; arg += 2) fits = PyLong_Check(args[arg]);
  if (!fits) return Refuse("wanted a tuple, an index, and an item");
  const Py_ssize_t size = PyTuple_GET_SIZE(args[0]);
  PyObject* const made = NewTuple(reinterpret_cast<PyObject*>(Py_TYPE(args[0])), size);
  if (made == nullptr) return nullptr;
  for (Py_ssize_t i = 0; i < size; ++i) PyTuple_SET_ITEM(made, i, Py_NewRef(PyTuple_GET_ITEM(args[0], i)));
  for (Py_ssize_t arg = 1; arg < num_args; arg += 2) {
    const Py_ssize_t place = PlaceIn(made, args[arg]);
    if (place < 0) {
      Py_DECREF(made);
      return Refuse("the tuple has no item of this index");
    }
    Py_DECREF(PyTuple_GET_ITEM(made, place));
    PyTuple_SET_ITEM(made, place, Py_NewRef(args[arg + 1]));
  }
  return made;
}

// to_pose(tuple, index, class): of the item that is the reading of a pose, x, y, qz, qw as x, y, yaw.
PyObject* ToPose(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  std::array<double, 4> numbers;
  const bool fits = num_args == 3 && PyTuple_Check(args[0]) && PyLong_Check(args[1]) && IsTupleClass(args[2]);
  const Py_ssize_t place = fits ? PlaceIn(args[0], args[1]) : -1;
  if (place < 0 || !ReadNumbers(PyTuple_GET_ITEM(args[0], place), &numbers)) {
    return Refuse("wanted a tuple with the reading of a pose, x, y, qz, qw, its index, and the class of poses");
  }
  numbers[2] = NormaliseAngle(2.0 * std::atan2(numbers[2], numbers[3]));
  PyObject* const made = NewTuple(args[2], 3);
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

/// What decisions are made of, and who decides.
struct DecisionKind {
  PyObject *decision, *twist, *message;  ///< classes
  long robot_id, num_robots;
};

// An attribute; None, without an error of Python's, where there is none of this name.
py::object Attribute(PyObject* object, PyObject* name) {
  PyObject* const value = PyObject_GetAttr(object, name);
  if (value == nullptr) PyErr_Clear();
  return value == nullptr ? py::none() : py::reinterpret_steal<py::object>(value);
}

// Whether a robot sends text of ASCII, in its own name, to a robot that there is or to all.
bool IsPlainMessage(PyObject* message, const DecisionKind& kind) {
  static PyObject *const payload = PyUnicode_InternFromString("payload"),
                         *const sender = PyUnicode_InternFromString("sender"),
                         *const receiver = PyUnicode_InternFromString("receiver");
  if (Py_TYPE(message) != reinterpret_cast<PyTypeObject*>(kind.message)) return false;
  const py::object text = Attribute(message, payload);
  return PyUnicode_CheckExact(text.ptr()) && PyUnicode_IS_ASCII(text.ptr()) &&
         IsWhole(Attribute(message, sender).ptr(), kind.robot_id, kind.robot_id) &&
         IsWhole(Attribute(message, receiver).ptr(), -1, kind.num_robots - 1);
}

bool ArePlainMessages(PyObject* outbox, const DecisionKind& kind) {
  if (!PyTuple_CheckExact(outbox)) return false;
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(outbox); ++i) {
    if (!IsPlainMessage(PyTuple_GET_ITEM(outbox, i), kind)) return false;
  }
  return true;
}

// Whether a decision is of its class, a named tuple of 8, with a twist of its own and a tuple of messages, and holds
// plain and finite values in their ranges. Most are and do, and this is asked of every robot in every step.
bool IsPlainDecision(PyObject* told, const DecisionKind& kind) {
  if (Py_TYPE(told) != reinterpret_cast<PyTypeObject*>(kind.decision) || PyTuple_GET_SIZE(told) != 8) return false;
  PyObject* const twist = PyTuple_GET_ITEM(told, 0);
  if (Py_TYPE(twist) != reinterpret_cast<PyTypeObject*>(kind.twist) || !AreFinite(twist, 3)) return false;
  PyObject* const goal = PyTuple_GET_ITEM(told, 3);
  if (!ArePlainMessages(PyTuple_GET_ITEM(told, 1), kind)) return false;
  if (goal != Py_None && !(PyTuple_CheckExact(goal) && AreFinite(goal, 2))) return false;
  constexpr long kLargest = 2147483647;  // messages of ROS have 32 bits for it
  return PyBool_Check(PyTuple_GET_ITEM(told, 2)) && PyFloat_CheckExact(PyTuple_GET_ITEM(told, 4)) &&
         IsWhole(PyTuple_GET_ITEM(told, 5), 0, kLargest) && IsWhole(PyTuple_GET_ITEM(told, 6), -1, kLargest) &&
         PyUnicode_CheckExact(PyTuple_GET_ITEM(told, 7));
}

// is_plain_decision(decision, (class of decisions, class of twists, class of messages, robot id, number of robots))
PyObject* AskIfPlain(PyObject* /*module*/, PyObject* const* args, Py_ssize_t num_args) {
  const bool fits = num_args == 2 && PyTuple_CheckExact(args[1]) && PyTuple_GET_SIZE(args[1]) == 5;
  const auto item = [&](Py_ssize_t i) { return PyTuple_GET_ITEM(args[1], i); };
  if (!fits || !PyLong_Check(item(3)) || !PyLong_Check(item(4))) {
    return Refuse("wanted a decision, and of what it is made: three classes, a robot's id, and how many there are");
  }
  const DecisionKind kind{item(0), item(1), item(2), PyLong_AsLong(item(3)), PyLong_AsLong(item(4))};
  return PyBool_FromLong(IsPlainDecision(args[0], kind) ? 1 : 0);
}

template <typename Function>
PyMethodDef MethodOf(const char* name, Function* function) {
  return {name, reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(function)), METH_FASTCALL, nullptr};
}

}  // namespace

void BindTupleCalls(py::module_& m) {
  static std::array<PyMethodDef, 5> functions{MethodOf("as_tuple", &AsTuple), MethodOf("with_items", &WithItems),
                                              MethodOf("to_pose", &ToPose), MethodOf("is_plain_decision", &AskIfPlain),
                                              PyMethodDef{nullptr, nullptr, 0, nullptr}};
  if (PyModule_AddFunctions(m.ptr(), functions.data()) != 0) throw py::error_already_set();
}

}  // namespace robotteamsim::bindings
