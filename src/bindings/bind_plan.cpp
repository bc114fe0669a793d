// Floor 1: planning on the known map.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <optional>
#include <utility>

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

}  // namespace

void BindPlan(py::module_& m) {
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
