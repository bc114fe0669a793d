#pragma once

#include <nanobind/nanobind.h>

namespace robotteamsim::bindings {

namespace nb = nanobind;
using namespace nb::literals;

// Each binds one floor of the library to a submodule of `robotteamsim._core`. The `nb::init` of a struct has its
// members in their order.
void BindBase(nb::module_&& m);
void BindPlan(nb::module_&& m);
void BindWorld(nb::module_&& m);
void BindPropagation(nb::module_&& m);
void BindHazards(nb::module_&& m);
void BindState(nb::module_&& m);
void BindSensing(nb::module_&& m);
void BindNetwork(nb::module_&& m);
void BindSwarm(nb::module_&& m);
void BindMaps(nb::module_&& m);
void BindControl(nb::module_&& m);
void BindSimulation(nb::module_&& m);
void BindLearning(nb::module_&& m);
void BindRecording(nb::module_&& m);

}  // namespace robotteamsim::bindings
