#pragma once

#include <pybind11/pybind11.h>

namespace robotteamsim::bindings {
void BindGeometry(pybind11::module_& m);
void BindTupleCalls(pybind11::module_& m);
void BindPlan(pybind11::module_& m);
void BindSwarm(pybind11::module_& m);
void BindControl(pybind11::module_& m);
void BindPropagation(pybind11::module_& m);
void BindNetwork(pybind11::module_& m);
void BindWorld(pybind11::module_& m);
void BindSensing(pybind11::module_& m);
void BindSimulation(pybind11::module_& m);
}  // namespace robotteamsim::bindings
