// Floor 3: who hears whom.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include <stdexcept>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

// Which pairs of robots have a link between two limits, which of these links have a signal below `endangered_below`,
// and the bytes of the first: bool, shape (n, n), no robot with itself. Link and rssi have the same shape.
py::tuple Links(const Doubles& link, double at_least, double at_most, const Doubles& rssi_dbm,
                double endangered_below) {
  const py::ssize_t n = link.shape(0);
  if (link.size() != n * n || rssi_dbm.size() != n * n) throw std::invalid_argument("link must have shape (n, n)");
  py::array_t<bool> adjacency({n, n}), endangered({n, n});
  bool *const is_link = adjacency.mutable_data(), *const is_weak = endangered.mutable_data();
  for (py::ssize_t i = 0; i < n * n; ++i) {
    is_link[i] = link.data()[i] >= at_least && link.data()[i] <= at_most && i % (n + 1) != 0;
    is_weak[i] = is_link[i] && rssi_dbm.data()[i] < endangered_below;
  }
  return py::make_tuple(adjacency, endangered, py::bytes(reinterpret_cast<const char*>(is_link), n * n));
}

}  // namespace

void BindNetwork(pybind11::module_& m) {
  m.def("links", &Links, pybind11::arg("link"), pybind11::arg("at_least"), pybind11::arg("at_most"),
        pybind11::arg("rssi_dbm"), pybind11::arg("endangered_below_dbm"));
  m.def("hop_count", &CountHops, pybind11::arg("adjacency"));
  m.def("fiedler_value", &FiedlerValue, pybind11::arg("adjacency"));
}

}  // namespace robotteamsim::bindings
