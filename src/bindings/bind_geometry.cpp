// Floor 0: lengths.
#include <pybind11/numpy.h>

#include "bindings.hpp"
#include "robotteamsim/geometry/hypot.hpp"

namespace robotteamsim::bindings {

void BindGeometry(pybind11::module_& m) {
  m.def("hypot", pybind11::vectorize(&Hypot), pybind11::arg("x"), pybind11::arg("y"));
}

}  // namespace robotteamsim::bindings
