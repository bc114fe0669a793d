// Floor 3: what robots perceive.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <vector>

#include "bindings.hpp"
#include "robotteamsim/sensing/laser.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using Noise = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array_t<float> Scan(const Laser& laser, const World& world, int robot_id, const Noise& noise_m) {
  const std::vector<float> ranges =
      laser.Report(laser.Scan(world, robot_id), {noise_m.data(), noise_m.data() + noise_m.size()});
  return py::array_t<float>(static_cast<py::ssize_t>(ranges.size()), ranges.data());
}

}  // namespace

void BindSensing(py::module_& m) {
  py::class_<Laser>(m, "Laser")
      .def(py::init([](const World& world, int beams, double angle_min_rad, double angle_max_rad, double forward_m,
                       double range_min_m, double range_max_m, double too_near_m, double no_return_m) {
             return Laser(
                 {beams, angle_min_rad, angle_max_rad, forward_m, range_min_m, range_max_m, too_near_m, no_return_m},
                 world);
           }),
           py::arg("world"), py::kw_only(), py::arg("beams"), py::arg("angle_min_rad"), py::arg("angle_max_rad"),
           py::arg("forward_m"), py::arg("range_min_m"), py::arg("range_max_m"), py::arg("too_near_m"),
           py::arg("no_return_m"))
      .def("scan", &Scan, py::arg("world"), py::arg("robot_id"), py::arg("noise_m"));
}

}  // namespace robotteamsim::bindings
