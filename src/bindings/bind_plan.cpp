// Floor 1: planning on the known map.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fast_calls.hpp"
#include "points.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using Cells = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using Field = py::array_t<float, py::array::c_style>;

PlanningGrid MakeGrid(const Cells& occupied, const Point& origin_m, double resolution_m, double inflation_m) {
  if (occupied.ndim() != 2) throw std::invalid_argument("occupied must have shape (rows, cols)");
  const GridShape shape{origin_m, resolution_m, static_cast<int>(occupied.shape(0)),
                        static_cast<int>(occupied.shape(1))};
  return PlanningGrid(shape, {occupied.data(), occupied.data() + occupied.size()}, inflation_m);
}

std::pair<Point, double> ToPair(const PlanningGrid::Valued& valued) { return {valued.place, valued.value}; }

template <typename Value>
py::array_t<Value> ToArray(const std::vector<Value>& values, const GridShape& shape) {
  py::array_t<Value> array({shape.rows, shape.cols});
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

float ValueAt(const PlanningGrid& grid, const Field& field, const Point& point) {
  return grid.ValueAt(field.data(), field.size(), point);
}

std::pair<Point, double> FirstStretch(const PlanningGrid& grid, const Point& start, const Point& goal,
                                      double max_length_m) {
  return ToPair(grid.FirstStretch(start, goal, max_length_m));
}

std::optional<std::pair<Point, double>> LeastReachable(const PlanningGrid& grid, const Field& field, const Point& start,
                                                       double radius_m) {
  const auto best = grid.LeastReachable(field.data(), field.size(), start, radius_m);
  return best ? std::optional(ToPair(*best)) : std::nullopt;
}

// Which places, shape (m, 2), have one of the points, shape (n, 2), no farther than their reach, shape (m,): pairs of a
// place and the point that is nearest to it, the first of equals; places ascending.
std::vector<std::pair<int, int>> Reached(const Doubles& points_m, const Doubles& places_m, const Doubles& reaches_m) {
  for (const Doubles* rows : {&points_m, &places_m}) {
    if (rows->ndim() != 2 || rows->shape(1) != 2) throw std::invalid_argument("points must have shape (n, 2)");
  }
  if (reaches_m.size() != places_m.shape(0)) throw std::invalid_argument("places must have one reach each");
  std::vector<std::pair<int, int>> reached;
  for (int k = 0; k < static_cast<int>(places_m.shape(0)); ++k) {
    const double *const place = places_m.data() + 2 * k, reach = reaches_m.data()[k];
    double best = std::nextafter(reach, std::numeric_limits<double>::infinity());
    int nearest = -1;
    for (int i = 0; i < static_cast<int>(points_m.shape(0)); ++i) {
      const double dx = points_m.data()[2 * i] - place[0], dy = points_m.data()[2 * i + 1] - place[1];
      if (std::abs(dx) > reach || std::abs(dy) > reach) continue;
      const double distance = std::hypot(dx, dy);
      if (distance < best) {
        best = distance;
        nearest = i;
      }
    }
    if (nearest >= 0) reached.emplace_back(k, nearest);
  }
  return reached;
}

}  // namespace

void BindPlan(py::module_& m) {
  DefFast<&Reached>(m, "reached");
  py::class_<PlanningGrid, std::shared_ptr<PlanningGrid>> grid(m, "PlanningGrid");
  grid.def(py::init(&MakeGrid), py::arg("occupied"), py::arg("origin_m"), py::arg("resolution_m"),
           py::arg("inflation_m"))
      .def("blocked", [](const PlanningGrid& grid) { return ToArray(grid.blocked(), grid.shape()); })
      .def("is_free", &PlanningGrid::IsFree)
      .def("distance_field",
           [](const PlanningGrid& grid, const Point& goal) { return ToArray(grid.DistanceField(goal), grid.shape()); })
      .def("shortest_path", &PlanningGrid::ShortestPath)
      .def("waypoints", [](const PlanningGrid& grid, const Point& start, const Point& goal, double max_length_m) {
        return grid.Shortcut(grid.ShortestPath(start, goal, max_length_m));
      });
  DefFast<&PlanningGrid::NearestFree>(grid, "nearest_free");
  DefFast<&PlanningGrid::IsLineFree>(grid, "is_line_free");
  DefFast<&ValueAt>(grid, "value_at");
  DefFast<&FirstStretch>(grid, "first_stretch");
  DefFast<&PlanningGrid::AlongWay>(grid, "along_way");
  DefFast<&LeastReachable>(grid, "least_reachable");
  DefFast<&PlanningGrid::NearestReachable>(grid, "nearest_reachable");
  DefFast<&PlanningGrid::ReachableTowards>(grid, "reachable_towards");
  DefFast<&PlanningGrid::NearestInDisc>(grid, "nearest_in_disc");
}

}  // namespace robotteamsim::bindings
