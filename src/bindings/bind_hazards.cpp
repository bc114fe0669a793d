// _core.hazards: fire, smoke and heat.
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/hazards/burning_floor.hpp"
#include "robotteamsim/hazards/grid_values.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::bindings {
namespace {

using Mask = Array<const bool, -1, -1>;
using Kinds = Array<const std::int32_t, -1, -1>;
using Values = Array<const double, -1, -1>;

template <typename Cells>
auto ListOf(const Cells& cells) {
  using Value = std::remove_const_t<std::remove_pointer_t<decltype(cells.data())>>;
  return std::vector<Value>(cells.data(), cells.data() + cells.size());
}

std::vector<std::uint8_t> FlagListOf(const Mask& mask) { return {mask.data(), mask.data() + mask.size()}; }

hazards::Links LinksOf(const Mask& east, const Mask& north, const std::vector<std::tuple<int, int, bool>>& crossings,
                       std::size_t doors) {
  std::vector<hazards::Crossing> found;
  found.reserve(crossings.size());
  for (const auto& [door, cell, is_east] : crossings) found.push_back({door, cell, is_east});
  return {static_cast<int>(east.shape(0)),
          static_cast<int>(east.shape(1)),
          FlagListOf(east),
          FlagListOf(north),
          std::move(found),
          static_cast<int>(doors)};
}

/// The values of all cells as an array of rows.
template <typename To, typename Value>
Array<To, -1, -1> CellsOf(const hazards::BurningFloor& floor, const std::vector<Value>& values) {
  const auto rows = static_cast<std::size_t>(floor.links().rows()),
             cols = static_cast<std::size_t>(floor.links().cols());
  auto cells = NewArray<To, -1, -1>({rows, cols});
  for (std::size_t i = 0; i < values.size(); ++i) cells.data()[i] = static_cast<To>(values[i]);
  return cells;
}

hazards::GridValues ViewOf(const Array<const float, -1, -1>& values, const base::Point& origin_m, double resolution_m) {
  return {{origin_m, resolution_m, static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1))},
          values.data()};
}

Array<double, -1> ValuesAt(const Array<const float, -1, -1>& values, const base::Point& origin_m, double resolution_m,
                           const Points& positions_m, double outside) {
  const std::vector<double> found =
      hazards::ValuesAt(ViewOf(values, origin_m, resolution_m), PointsOf(positions_m), outside);
  auto array = NewArray<double, -1>({found.size()});
  std::copy(found.begin(), found.end(), array.data());
  return array;
}

std::vector<base::Point> HotInSight(const Array<const float, -1, -1>& temperatures_c, const base::Point& origin_m,
                                    double resolution_m, double limit_c, const plan::PlanningGrid& sight,
                                    const base::Point& place_m, double range_m) {
  return hazards::HotInSight(ViewOf(temperatures_c, origin_m, resolution_m), limit_c, sight, place_m, range_m);
}

void BindBurningFloor(nb::module_& m) {
  using Floor = hazards::BurningFloor;
  nb::class_<Floor>(m, "BurningFloor")
      .def(
          "__init__",
          [](Floor* self, const Mask& east, const Mask& north, const std::vector<std::tuple<int, int, bool>>& crossings,
             const std::vector<std::tuple<bool, double, double>>& doors,
             const std::vector<std::tuple<double, double, double>>& fuels, const Kinds& fuel_of_cell,
             const Values& thresholds, double cell_m, double diffusivity_m2_s, double ambient_c, double heat_kj_m2_k,
             double convection_kw_m2_k, double emissivity, double soot_g_kj, double convective_share) {
            hazards::Links links = LinksOf(east, north, crossings, doors.size());
            std::vector<hazards::Fuel> kinds;
            for (const auto& [load, peak, growth] : fuels) kinds.push_back({load, peak, growth});
            std::vector<hazards::DoorModel> leaves;
            for (const auto& [closed, leakage, endures] : doors) leaves.push_back({closed, leakage, endures});
            const auto found = ListOf(fuel_of_cell);
            hazards::Fire fire(links, std::move(kinds), {found.begin(), found.end()}, ListOf(thresholds));
            const hazards::AirModel air{cell_m,       diffusivity_m2_s,   ambient_c + 273.15,
                                        heat_kj_m2_k, convection_kw_m2_k, emissivity};
            new (self) Floor(std::move(links), std::move(fire), air, {soot_g_kj, convective_share}, std::move(leaves));
          },
          "east"_a, "north"_a, "crossings"_a, "doors"_a, "fuels"_a, "fuel_of_cell"_a, "thresholds"_a, nb::kw_only(),
          "cell_m"_a, "diffusivity_m2_s"_a, "ambient_c"_a, "heat_kj_m2_k"_a, "convection_kw_m2_k"_a, "emissivity"_a,
          "soot_g_kj"_a, "convective_share"_a)
      .def("ignite", &Floor::Ignite, "cell"_a)
      .def("set_door", &Floor::SetDoor, "door"_a, "closed"_a)
      .def("advance", &Floor::Advance, "seconds"_a)
      .def("is_burnt_through", &Floor::IsBurntThrough, "door"_a)
      .def_prop_ro("heat_release_kw", [](const Floor& floor) { return floor.fire().heat_release_rate(); })
      .def("states", [](const Floor& floor) { return CellsOf<std::uint8_t>(floor, floor.States()); })
      .def("soot_g_m2", [](const Floor& floor) { return CellsOf<double>(floor, floor.Soot()); })
      .def(
          "soot_g_m3",
          [](const Floor& floor, double height_m) { return CellsOf<float>(floor, floor.SootDensity(height_m)); },
          "height_m"_a)
      .def(
          "temperature_c",
          [](const Floor& floor, float ambient_c, float flame_c) {
            return CellsOf<float>(floor, floor.Temperature(ambient_c, flame_c));
          },
          "ambient_c"_a, "flame_c"_a);
}

void BindHaze(nb::module_& m) {
  nb::class_<hazards::Haze>(m, "Haze").def(
      "__init__",
      [](hazards::Haze* self, const base::Point& origin_m, double resolution_m,
         const Array<const float, -1, -1>& soot_g_m3, double extinction_m2_g, double limit) {
        const plan::GridShape shape{origin_m, resolution_m, static_cast<int>(soot_g_m3.shape(0)),
                                    static_cast<int>(soot_g_m3.shape(1))};
        new (self) hazards::Haze(shape, ListOf(soot_g_m3), extinction_m2_g, limit);
      },
      "origin_m"_a, "resolution_m"_a, "soot_g_m3"_a, "extinction_m2_g"_a, "limit"_a);
}

}  // namespace

void BindHazards(nb::module_&& m) {
  BindBurningFloor(m);
  BindHaze(m);
  m.def("values_at", &ValuesAt, "values"_a, "origin_m"_a, "resolution_m"_a, "positions_m"_a, "outside"_a);
  m.def("hot_in_sight", &HotInSight, "temperatures_c"_a, "origin_m"_a, "resolution_m"_a, "limit_c"_a, "sight"_a,
        "place_m"_a, "range_m"_a);
}

}  // namespace robotteamsim::bindings
