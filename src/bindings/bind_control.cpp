// Floor 5: what a controller reads from its laser.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "robotteamsim/control/clearance.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using Ranges = py::array_t<float, py::array::c_style | py::array::forcecast>;

std::vector<float> ToVector(const Ranges& ranges) { return {ranges.data(), ranges.data() + ranges.size()}; }

py::array_t<double> Hits(const ScanClearance& clearance, const Ranges& ranges, double max_distance_m) {
  const std::vector<Point> hits = clearance.Hits(ToVector(ranges), max_distance_m);
  py::array_t<double> array({static_cast<py::ssize_t>(hits.size()), py::ssize_t{2}});
  double* out = array.mutable_data();
  for (const Point& hit : hits) {
    *out++ = hit.x;
    *out++ = hit.y;
  }
  return array;
}

}  // namespace

void BindControl(py::module_& m) {
  py::class_<ScanClearance>(m, "ScanClearance")
      .def(py::init([](int beams, double angle_min_rad, double angle_max_rad, double forward_m, double range_max_m) {
             return ScanClearance({beams, angle_min_rad, angle_max_rad, forward_m, range_max_m});
           }),
           py::arg("beams"), py::arg("angle_min_rad"), py::arg("angle_max_rad"), py::arg("forward_m"),
           py::arg("range_max_m"))
      .def("hits", &Hits, py::arg("ranges_m"), py::arg("max_distance_m"))
      .def("free_distance",
           [](const ScanClearance& clearance, const Ranges& ranges, double heading_rad, double radius_m,
              double max_distance_m) {
             return clearance.FreeDistance(ToVector(ranges), heading_rad, radius_m, max_distance_m);
           })
      .def("free_distances", [](const ScanClearance& clearance, const Ranges& ranges,
                                const std::vector<double>& headings_rad, double radius_m, double max_distance_m) {
        return clearance.FreeDistances(ToVector(ranges), headings_rad, radius_m, max_distance_m);
      });
}

}  // namespace robotteamsim::bindings
