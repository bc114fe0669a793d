// _core.plan: path planning on the known map.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::bindings {
namespace {

using DistanceMap = Array<const float, -1, -1>;
using Valued = std::pair<base::Point, double>;

void InitGrid(plan::PlanningGrid* self, const Array<const bool, -1, -1>& occupied, const base::Point& origin_m,
              double resolution_m, double inflation_m) {
  const plan::GridShape shape{origin_m, resolution_m, static_cast<int>(occupied.shape(0)),
                              static_cast<int>(occupied.shape(1))};
  new (self) plan::PlanningGrid(shape, {occupied.data(), occupied.data() + occupied.size()}, inflation_m);
}

template <typename Value>
Array<Value, -1, -1> CellsOf(const std::vector<Value>& values, const plan::GridShape& shape) {
  auto cells = NewArray<Value, -1, -1>({static_cast<std::size_t>(shape.rows), static_cast<std::size_t>(shape.cols)});
  std::copy(values.begin(), values.end(), cells.data());
  return cells;
}

Valued FirstStretch(const plan::PlanningGrid& grid, const base::Point& start, const base::Point& goal,
                    double max_length_m) {
  const plan::PlanningGrid::Valued bend = grid.FirstStretch(start, goal, max_length_m);
  return {bend.place, bend.value};
}

std::optional<Valued> LeastReachable(const plan::PlanningGrid& grid, const DistanceMap& distances,
                                     const base::Point& start, double radius_m) {
  const auto best = grid.LeastReachable(distances.data(), distances.size(), start, radius_m);
  return best ? std::optional<Valued>({best->place, best->value}) : std::nullopt;
}

}  // namespace

void BindPlan(nb::module_&& m) {
  nb::class_<plan::PlanningGrid>(m, "PlanningGrid")
      .def("__init__", &InitGrid, "occupied"_a, "origin_m"_a, "resolution_m"_a, "inflation_m"_a)
      .def("blocked", [](const plan::PlanningGrid& grid) { return CellsOf(grid.blocked(), grid.shape()); })
      .def("is_free", &plan::PlanningGrid::IsFree, "point_m"_a)
      .def("nearest_free", &plan::PlanningGrid::NearestFree, "point_m"_a, "max_distance_m"_a)
      .def("is_line_free", &plan::PlanningGrid::IsLineFree, "start_m"_a, "end_m"_a)
      .def(
          "distance_map",
          [](const plan::PlanningGrid& grid, const base::Point& goal) {
            return CellsOf(grid.DistanceMap(goal), grid.shape());
          },
          "goal_m"_a)
      .def(
          "value_at",
          [](const plan::PlanningGrid& grid, const DistanceMap& distances, const base::Point& point) {
            return grid.ValueAt(distances.data(), distances.size(), point);
          },
          "distances_m"_a, "point_m"_a)
      .def(
          "descend",
          [](const plan::PlanningGrid& grid, const DistanceMap& distances, const base::Point& start,
             double look_ahead_m) { return grid.Descend(distances.data(), distances.size(), start, look_ahead_m); },
          "distances_m"_a, "start_m"_a, "look_ahead_m"_a)
      .def("shortest_path", &plan::PlanningGrid::ShortestPath, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("waypoints", &plan::PlanningGrid::Waypoints, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("first_stretch", &FirstStretch, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("along_path", &plan::PlanningGrid::AlongPath, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("least_reachable", &LeastReachable, "distances_m"_a, "start_m"_a, "radius_m"_a)
      .def("nearest_reachable", &plan::PlanningGrid::NearestReachable, "start_m"_a, "goal_m"_a, "radius_m"_a)
      .def("reachable_towards", &plan::PlanningGrid::ReachableTowards, "start_m"_a, "goal_m"_a)
      .def("nearest_in_disc", &plan::PlanningGrid::NearestInDisc, "center_m"_a, "goal_m"_a, "radius_m"_a);
}

}  // namespace robotteamsim::bindings
