#pragma once

#include <nanobind/nanobind.h>

namespace robotteamsim::bindings {

// Each binds one floor of the library as a submodule of `robotteamsim._core`.
void BindBase(nanobind::module_& m);
void BindPlan(nanobind::module_& m);
void BindWorld(nanobind::module_& m);
void BindPropagation(nanobind::module_& m);
void BindSensing(nanobind::module_& m);
void BindNetwork(nanobind::module_& m);
void BindSwarm(nanobind::module_& m);
void BindControl(nanobind::module_& m);
void BindSimulation(nanobind::module_& m);

}  // namespace robotteamsim::bindings
