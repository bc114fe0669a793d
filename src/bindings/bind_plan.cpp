// _core.plan: path planning on the known map.
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace nanobind::detail {

using robotteamsim::plan::PlanningGrid;
using robotteamsim::plan::Portal;

template <>
struct type_caster<Portal> : TupleCaster<Portal, &Portal::a, &Portal::b, &Portal::length_m> {};

template <>
struct type_caster<PlanningGrid::Valued>
    : TupleCaster<PlanningGrid::Valued, &PlanningGrid::Valued::place, &PlanningGrid::Valued::value> {};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using plan::PlanningGrid;
using DistanceMap = Array<const float, -1, -1>;

void InitGrid(PlanningGrid* self, const Array<const bool, -1, -1>& occupied, const base::Point& origin_m,
              double resolution_m, double inflation_m, const std::vector<plan::Portal>& portals) {
  const plan::GridShape shape{origin_m, resolution_m, static_cast<int>(occupied.shape(0)),
                              static_cast<int>(occupied.shape(1))};
  new (self) PlanningGrid(shape, ValuesOf<std::uint8_t>(occupied), inflation_m, portals);
}

template <typename Value>
Array<Value, -1, -1> OfCells(const PlanningGrid& grid, std::vector<Value> values) {
  return CellsOf<Value>(std::move(values), grid.shape().rows, grid.shape().cols);
}

}  // namespace

void BindPlan(nb::module_&& m) {
  nb::class_<PlanningGrid>(m, "PlanningGrid",
                           "Cells that are free for a robot's centre, and shortest paths through them.\n\n"
                           "Arrays have shape (rows, columns), row 0 at the lowest y. Points are (x, y) in `map` [m].")
      .def("__init__", &InitGrid, "occupied"_a, "origin_m"_a, "resolution_m"_a, "inflation_m"_a,
           "portals"_a = std::vector<plan::Portal>())
      .def(
          "blocked", [](const PlanningGrid& grid) { return OfCells(grid, grid.blocked()); },
          "Return which cells are not free, bool.")
      .def("is_free", &PlanningGrid::IsFree, "point_m"_a, "Whether a point lies in a free cell.")
      .def("nearest_free", &PlanningGrid::NearestFree, "point_m"_a, "max_distance_m"_a,
           "Return a point itself if it is free, else the centre of the nearest free cell; None if it is farther away.")
      .def("is_line_free", &PlanningGrid::IsLineFree, "start_m"_a, "end_m"_a,
           "Whether a straight line crosses only free cells.")
      .def(
          "distance_map",
          [](const PlanningGrid& grid, const base::Point& goal) {
            std::vector<float> distances;
            {
              const nb::gil_scoped_release others_run;  // such as progress: in a large building, it takes half a minute
              distances = grid.DistanceMap(goal);
            }
            return OfCells(grid, std::move(distances));
          },
          "goal_m"_a,
          "Return the length of the shortest path between each cell and a free goal, float32 [m]; inf without one.")
      .def(
          "value_at",
          [](const PlanningGrid& grid, const DistanceMap& distances, const base::Point& point) {
            return grid.ValueAt(distances.data(), distances.size(), point);
          },
          "distances_m"_a, "point_m"_a, "Return the value of a distance map at a point; inf beyond the grid.")
      .def(
          "values_near",
          [](const PlanningGrid& grid, const DistanceMap& distances, const Points& points, double max_distance_m) {
            std::vector<double> values;
            for (const base::Point& point : RecordsOf<base::Point>(points)) {
              const std::optional<base::Point> free = grid.NearestFree(point, max_distance_m);
              values.push_back(free ? grid.ValueAt(distances.data(), distances.size(), *free)
                                    : std::numeric_limits<double>::infinity());
            }
            return ArrayOf(std::move(values));
          },
          "distances_m"_a, "points_m"_a, "max_distance_m"_a,
          "Return the values of a distance map at the nearest free cells of points; inf where none is near enough.")
      .def(
          "descend",
          [](const PlanningGrid& grid, const DistanceMap& distances, const base::Point& start, double look_ahead_m) {
            return grid.Descend(distances.data(), distances.size(), start, look_ahead_m);
          },
          "distances_m"_a, "start_m"_a, "look_ahead_m"_a,
          "Return the next point on the path to the goal of a distance map, on a free line; None without a path.")
      .def("shortest_path", &PlanningGrid::ShortestPath, "start_m"_a, "goal_m"_a, "max_length_m"_a,
           "Return the cell centres of a shortest path; [] if an end is blocked or the path is longer.")
      .def("waypoints", &PlanningGrid::Waypoints, "start_m"_a, "goal_m"_a, "max_length_m"_a,
           "Return the corners of a shortest path with its ends; [] as `shortest_path`.")
      .def("first_stretch", &PlanningGrid::FirstStretch, "start_m"_a, "goal_m"_a, "max_length_m"_a,
           "Return the first corner of a shortest path, and the length of the path [m].\n\n"
           "Without a path of at most `max_length_m`: the goal, and its straight distance.")
      .def("along_path", &PlanningGrid::AlongPath, "start_m"_a, "goal_m"_a, "max_length_m"_a,
           "Return the point in the direction of the first corner, at the length of the path.")
      .def(
          "least_reachable",
          [](const PlanningGrid& grid, const DistanceMap& distances, const base::Point& start, double radius_m) {
            return grid.LeastReachable(distances.data(), distances.size(), start, radius_m);
          },
          "distances_m"_a, "start_m"_a, "radius_m"_a,
          "Return the cell with the least value of a distance map, and the value, of those that can be reached "
          "within a disc around the start; None if there is none.")
      .def("nearest_reachable", &PlanningGrid::NearestReachable, "start_m"_a, "goal_m"_a, "radius_m"_a,
           "Return, of the same cells, the one nearest to the goal; None if the start is blocked.")
      .def("reachable_towards", &PlanningGrid::ReachableTowards, "start_m"_a, "goal_m"_a,
           "Return the goal if the straight line to it is free, else the reachable point nearest to it.")
      .def("nearest_in_disc", &PlanningGrid::NearestInDisc, "center_m"_a, "goal_m"_a, "radius_m"_a,
           "Return the free cell in a disc that is nearest to the goal; None if there is none.");
}

}  // namespace robotteamsim::bindings
