// Floor 4: how the robots of a swarm move.
#include <array>
#include <cstddef>
#include <stdexcept>

#include "bindings.hpp"
#include "fast_calls.hpp"
#include "points.hpp"
#include "robotteamsim/swarm/velocity.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

// The next item of an iterator; nothing at its end.
py::object Next(const py::object& iterator) {
  PyObject* const item = PyIter_Next(iterator.ptr());
  if (item == nullptr && PyErr_Occurred() != nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(item);
}

// The next of the random numbers.
double NextNumber(const py::object& numbers) {
  const py::object number = Next(numbers);
  if (!number) throw std::invalid_argument("there must be a random number for each attractor");
  const double value = PyFloat_AsDouble(number.ptr());
  if (value == -1.0 && PyErr_Occurred() != nullptr) throw py::error_already_set();
  return value;
}

// v[t+1] of four attractors, their weights, and the next four of an iterator of random numbers.
Point VelocityOf(const Point& position, const Point& inertia, const py::tuple& attractors, const py::tuple& weights,
                 const py::object& numbers) {
  std::array<Pull, 4> pulls;
  std::array<double, 4> weight;
  if (attractors.size() != pulls.size() || !ReadNumbers(weights, &weight)) {
    throw py::type_error("wanted four attractors, and a weight of each");
  }
  if (PyIter_Check(numbers.ptr()) == 0) throw py::type_error("wanted an iterator of random numbers");
  for (std::size_t i = 0; i < pulls.size(); ++i) {
    std::array<double, 2> place;
    if (!ReadNumbers(PyTuple_GET_ITEM(attractors.ptr(), static_cast<Py_ssize_t>(i)), &place)) {
      throw py::type_error("an attractor must be (x, y)");
    }
    pulls[i] = {weight[i], NextNumber(numbers), {place[0], place[1]}};
  }
  return NextVelocity(position, inertia, pulls);
}

// Past velocities, newest first, by their weights; missing ones count as zero.
Point MemoryTerm(const py::tuple& coefficients, const py::object& velocities) {
  const auto rest = py::reinterpret_steal<py::object>(PyObject_GetIter(velocities.ptr()));
  if (!rest) throw py::error_already_set();
  Point sum{0.0, 0.0};
  for (const py::handle coefficient : coefficients) {
    const py::object velocity = Next(rest);
    if (!velocity) break;
    std::array<double, 2> parts;
    if (!ReadNumbers(velocity, &parts)) throw py::type_error("a velocity must be (x, y)");
    const auto weight = coefficient.cast<double>();
    sum.x += weight * parts[0];
    sum.y += weight * parts[1];
  }
  return sum;
}

}  // namespace

void BindSwarm(py::module_& m) {
  DefFast<&VelocityOf>(m, "next_velocity");
  DefFast<&MemoryTerm>(m, "memory_term");
}

}  // namespace robotteamsim::bindings
