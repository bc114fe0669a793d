// Floor 1: planning on the known map.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace py = pybind11;

namespace robotteamsim::bindings {
namespace {

using XY = std::pair<double, double>;
using Cells = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using Field = py::array_t<float, py::array::c_style>;

Point ToPoint(const XY& xy) { return {xy.first, xy.second}; }

std::optional<XY> ToXY(const std::optional<Point>& point) {
  if (!point) return std::nullopt;
  return XY{point->x, point->y};
}

std::vector<XY> ToXY(const std::vector<Point>& points) {
  std::vector<XY> result;
  for (const Point& point : points) result.emplace_back(point.x, point.y);
  return result;
}

PlanningGrid MakeGrid(const Cells& occupied, const XY& origin_m, double resolution_m, double inflation_m) {
  if (occupied.ndim() != 2) throw std::invalid_argument("occupied must have shape (rows, cols)");
  const GridShape shape{ToPoint(origin_m), resolution_m, static_cast<int>(occupied.shape(0)),
                        static_cast<int>(occupied.shape(1))};
  return PlanningGrid(shape, {occupied.data(), occupied.data() + occupied.size()}, inflation_m);
}

template <typename Value>
py::array_t<Value> ToArray(const std::vector<Value>& values, const GridShape& shape) {
  py::array_t<Value> array({shape.rows, shape.cols});
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

// For each place, shape (m, 2): which of the points, shape (n, 2), is nearest, the first of equals, and how far it is.
std::pair<std::vector<int>, std::vector<double>> Nearest(const Doubles& points_m, const Doubles& places_m) {
  for (const Doubles* rows : {&points_m, &places_m}) {
    if (rows->ndim() != 2 || rows->shape(1) != 2) throw std::invalid_argument("points must have shape (n, 2)");
  }
  if (points_m.shape(0) == 0) throw std::invalid_argument("of no points, none is nearest");
  std::pair<std::vector<int>, std::vector<double>> nearest;
  for (const double* place = places_m.data(); place != places_m.data() + places_m.size(); place += 2) {
    int best = 0;
    double best_m = std::numeric_limits<double>::infinity();
    for (int i = 0; i < static_cast<int>(points_m.shape(0)); ++i) {
      const double* const point = points_m.data() + 2 * i;
      const double distance_m = std::hypot(point[0] - place[0], point[1] - place[1]);
      if (distance_m < best_m) {
        best = i;
        best_m = distance_m;
      }
    }
    nearest.first.push_back(best);
    nearest.second.push_back(best_m);
  }
  return nearest;
}

}  // namespace

void BindPlan(py::module_& m) {
  m.def("nearest", &Nearest, py::arg("points_m"), py::arg("places_m"));
  py::class_<PlanningGrid>(m, "PlanningGrid")
      .def(py::init(&MakeGrid), py::arg("occupied"), py::arg("origin_m"), py::arg("resolution_m"),
           py::arg("inflation_m"))
      .def("blocked", [](const PlanningGrid& grid) { return ToArray(grid.blocked(), grid.shape()); })
      .def("is_free", [](const PlanningGrid& grid, const XY& point) { return grid.IsFree(ToPoint(point)); })
      .def("nearest_free", [](const PlanningGrid& grid, const XY& point,
                              double max_distance_m) { return ToXY(grid.NearestFree(ToPoint(point), max_distance_m)); })
      .def("is_line_free",
           [](const PlanningGrid& grid, const XY& a, const XY& b) { return grid.IsLineFree(ToPoint(a), ToPoint(b)); })
      .def("distance_field", [](const PlanningGrid& grid,
                                const XY& goal) { return ToArray(grid.DistanceField(ToPoint(goal)), grid.shape()); })
      .def("value_at", [](const PlanningGrid& grid, const Field& field,
                          const XY& point) { return grid.ValueAt(field.data(), field.size(), ToPoint(point)); })
      .def("shortest_path",
           [](const PlanningGrid& grid, const XY& start, const XY& goal, double max_length_m) {
             return ToXY(grid.ShortestPath(ToPoint(start), ToPoint(goal), max_length_m));
           })
      .def("waypoints",
           [](const PlanningGrid& grid, const XY& start, const XY& goal, double max_length_m) {
             return ToXY(grid.Shortcut(grid.ShortestPath(ToPoint(start), ToPoint(goal), max_length_m)));
           })
      .def("least_reachable",
           [](const PlanningGrid& grid, const Field& field, const XY& start, double radius_m) {
             return ToXY(grid.LeastReachable(field.data(), field.size(), ToPoint(start), radius_m));
           })
      .def("nearest_reachable",
           [](const PlanningGrid& grid, const XY& start, const XY& goal, double radius_m) {
             return ToXY(grid.NearestReachable(ToPoint(start), ToPoint(goal), radius_m));
           })
      .def("nearest_in_disc", [](const PlanningGrid& grid, const XY& center, const XY& goal, double radius_m) {
        return ToXY(grid.NearestInDisc(ToPoint(center), ToPoint(goal), radius_m));
      });
}

}  // namespace robotteamsim::bindings
