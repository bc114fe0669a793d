// _core.plan: path planning on the known map.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace nanobind::detail {

using robotteamsim::plan::PlanningGrid;

template <>
struct type_caster<PlanningGrid::Valued>
    : TupleCaster<PlanningGrid::Valued, &PlanningGrid::Valued::place, &PlanningGrid::Valued::value> {};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using plan::PlanningGrid;
using DistanceMap = Array<const float, -1, -1>;

void InitGrid(PlanningGrid* self, const Array<const bool, -1, -1>& occupied, const base::Point& origin_m,
              double resolution_m, double inflation_m) {
  const plan::GridShape shape{origin_m, resolution_m, static_cast<int>(occupied.shape(0)),
                              static_cast<int>(occupied.shape(1))};
  new (self) PlanningGrid(shape, ValuesOf<std::uint8_t>(occupied), inflation_m);
}

template <typename Value>
Array<Value, -1, -1> OfCells(const PlanningGrid& grid, std::vector<Value> values) {
  return CellsOf<Value>(std::move(values), grid.shape().rows, grid.shape().cols);
}

}  // namespace

void BindPlan(nb::module_&& m) {
  nb::class_<PlanningGrid>(m, "PlanningGrid")
      .def("__init__", &InitGrid, "occupied"_a, "origin_m"_a, "resolution_m"_a, "inflation_m"_a)
      .def("blocked", [](const PlanningGrid& grid) { return OfCells(grid, grid.blocked()); })
      .def("is_free", &PlanningGrid::IsFree, "point_m"_a)
      .def("nearest_free", &PlanningGrid::NearestFree, "point_m"_a, "max_distance_m"_a)
      .def("is_line_free", &PlanningGrid::IsLineFree, "start_m"_a, "end_m"_a)
      .def(
          "distance_map",
          [](const PlanningGrid& grid, const base::Point& goal) { return OfCells(grid, grid.DistanceMap(goal)); },
          "goal_m"_a)
      .def(
          "value_at",
          [](const PlanningGrid& grid, const DistanceMap& distances, const base::Point& point) {
            return grid.ValueAt(distances.data(), distances.size(), point);
          },
          "distances_m"_a, "point_m"_a)
      .def(
          "descend",
          [](const PlanningGrid& grid, const DistanceMap& distances, const base::Point& start, double look_ahead_m) {
            return grid.Descend(distances.data(), distances.size(), start, look_ahead_m);
          },
          "distances_m"_a, "start_m"_a, "look_ahead_m"_a)
      .def("shortest_path", &PlanningGrid::ShortestPath, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("waypoints", &PlanningGrid::Waypoints, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("first_stretch", &PlanningGrid::FirstStretch, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def("along_path", &PlanningGrid::AlongPath, "start_m"_a, "goal_m"_a, "max_length_m"_a)
      .def(
          "least_reachable",
          [](const PlanningGrid& grid, const DistanceMap& distances, const base::Point& start, double radius_m) {
            return grid.LeastReachable(distances.data(), distances.size(), start, radius_m);
          },
          "distances_m"_a, "start_m"_a, "radius_m"_a)
      .def("nearest_reachable", &PlanningGrid::NearestReachable, "start_m"_a, "goal_m"_a, "radius_m"_a)
      .def("reachable_towards", &PlanningGrid::ReachableTowards, "start_m"_a, "goal_m"_a)
      .def("nearest_in_disc", &PlanningGrid::NearestInDisc, "center_m"_a, "goal_m"_a, "radius_m"_a);
}

}  // namespace robotteamsim::bindings
