// The private module robotteamsim._core: one bind function per floor of the C++ library.
#include "bindings.hpp"

PYBIND11_MODULE(_core, m) {
  m.doc() = "C++ core of robotteamsim; use the typed Python packages instead.";
  robotteamsim::bindings::BindGeometry(m);
  robotteamsim::bindings::BindTupleCalls(m);
  robotteamsim::bindings::BindPlan(m);
  robotteamsim::bindings::BindSwarm(m);
  robotteamsim::bindings::BindControl(m);
  robotteamsim::bindings::BindPropagation(m);
  robotteamsim::bindings::BindNetwork(m);
  robotteamsim::bindings::BindWorld(m);
  robotteamsim::bindings::BindSensing(m);
  robotteamsim::bindings::BindSimulation(m);
}
