// Floor 5: what a controller reads from its laser.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "arrays.hpp"
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

double SquaredDistanceToNearest(const Doubles& points, double x, double y) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const double* point = points.data(); point != points.data() + points.size(); point += 2) {
    const double dx = x - point[0], dy = y - point[1];
    nearest = std::min(nearest, dx * dx + dy * dy);
  }
  return nearest;
}

// The index of the candidate that is farther from all points than `place` and than the candidates before it; -1 where
// none is farther than `place`. Arrays have the shape (n, 2).
int FarthestFrom(const Doubles& points_m, const std::pair<double, double>& place_m, const Doubles& candidates_m) {
  for (const Doubles* rows : {&points_m, &candidates_m}) {
    if (rows->ndim() != 2 || rows->shape(1) != 2) throw std::invalid_argument("points must have shape (n, 2)");
  }
  int best = -1;
  double farthest = SquaredDistanceToNearest(points_m, place_m.first, place_m.second);
  for (int i = 0; i < static_cast<int>(candidates_m.shape(0)); ++i) {
    const double* const candidate = candidates_m.data() + 2 * i;
    const double distance = SquaredDistanceToNearest(points_m, candidate[0], candidate[1]);
    if (distance > farthest) {
      farthest = distance;
      best = i;
    }
  }
  return best;
}

}  // namespace

void BindControl(py::module_& m) {
  m.def("farthest_from", &FarthestFrom, py::arg("points_m"), py::arg("place_m"), py::arg("candidates_m"));
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
  py::class_<Sidestepper>(m, "Sidestepper")
      .def(py::init<ScanClearance, std::vector<double>>(), py::arg("clearance"), py::arg("headings_rad"))
      .def("find",
           [](Sidestepper& sidestepper, const Ranges& ranges, double wanted_rad, double radius_m, double needed_m) {
             const Sidestepper::Way way = sidestepper.Find(ToVector(ranges), wanted_rad, radius_m, needed_m);
             return std::pair(way.heading, way.free);
           });
}

}  // namespace robotteamsim::bindings
