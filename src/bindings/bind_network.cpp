// Floor 3: who hears whom.
#include <pybind11/eigen.h>

#include "bindings.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"

namespace robotteamsim::bindings {

void BindNetwork(pybind11::module_& m) {
  m.def("hop_count", &CountHops, pybind11::arg("adjacency"));
  m.def("fiedler_value", &FiedlerValue, pybind11::arg("adjacency"));
}

}  // namespace robotteamsim::bindings
