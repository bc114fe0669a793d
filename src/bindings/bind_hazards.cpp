// _core.hazards: fire, smoke and heat.
#include <cstdint>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/hazards/burning_floor.hpp"
#include "robotteamsim/hazards/grid_values.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace nanobind::detail {

namespace hazards = robotteamsim::hazards;

template <>
struct type_caster<hazards::Crossing>
    : TupleCaster<hazards::Crossing, &hazards::Crossing::door, &hazards::Crossing::cell, &hazards::Crossing::is_east> {
};

template <>
struct type_caster<hazards::OpeningCell>
    : TupleCaster<hazards::OpeningCell, &hazards::OpeningCell::above, &hazards::OpeningCell::below,
                  &hazards::OpeningCell::share, &hazards::OpeningCell::area_m2, &hazards::OpeningCell::rise_m> {};

template <>
struct type_caster<hazards::DoorModel>
    : TupleCaster<hazards::DoorModel, &hazards::DoorModel::closed, &hazards::DoorModel::open_share,
                  &hazards::DoorModel::closed_share, &hazards::DoorModel::endures_s> {};

template <>
struct type_caster<hazards::Fuel> : TupleCaster<hazards::Fuel, &hazards::Fuel::load_kj, &hazards::Fuel::peak_kw,
                                                &hazards::Fuel::growth_kw_s2, &hazards::Fuel::curve> {};

}  // namespace nanobind::detail

namespace robotteamsim::bindings {
namespace {

using hazards::BurningFloor;
using Mask = Array<const bool, -1, -1>;
using Kinds = Array<const std::int32_t, -1, -1>;
using Values = Array<const float, -1, -1>;

template <typename Value, typename Stored>
Array<Value, -1, -1> OfCells(const BurningFloor& floor, std::vector<Stored> values) {
  return CellsOf<Value>(std::move(values), floor.links().rows(), floor.links().cols());
}

plan::GridShape ShapeOf(const Values& values, const base::Point& origin_m, double resolution_m) {
  return {origin_m, resolution_m, static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1))};
}

void InitFloor(BurningFloor* self, const Mask& east, const Mask& north, std::vector<hazards::Crossing> crossings,
               std::vector<hazards::DoorModel> doors, std::vector<hazards::OpeningCell> openings,
               std::vector<hazards::Fuel> fuels, const Kinds& fuel_of_cell, double gap_m, double cell_m,
               double diffusivity_m2_s, double height_m, double ambient_c, double heat_kj_m3_k,
               double convection_kw_m2_k, double emissivity, double soot_g_kj, double convective_share) {
  hazards::Links links(static_cast<int>(east.shape(0)), static_cast<int>(east.shape(1)), ValuesOf<std::uint8_t>(east),
                       ValuesOf<std::uint8_t>(north), std::move(crossings), static_cast<int>(doors.size()));
  hazards::Fire fire(links, std::move(fuels), ValuesOf<int>(fuel_of_cell), gap_m / cell_m);
  const hazards::AirModel air{
      cell_m, diffusivity_m2_s, ambient_c + 273.15, heat_kj_m3_k * height_m, convection_kw_m2_k, emissivity, height_m};
  new (self) BurningFloor(std::move(links), std::move(fire), air, {soot_g_kj, convective_share}, std::move(doors),
                          std::move(openings));
}

void BindBurningFloor(nb::module_& m) {
  nb::class_<BurningFloor>(m, "BurningFloor")
      .def("__init__", &InitFloor, "east"_a, "north"_a, "crossings"_a, "doors"_a, "openings"_a, "fuels"_a,
           "fuel_of_cell"_a, nb::kw_only(), "gap_m"_a, "cell_m"_a, "diffusivity_m2_s"_a, "height_m"_a, "ambient_c"_a,
           "heat_kj_m3_k"_a, "convection_kw_m2_k"_a, "emissivity"_a, "soot_g_kj"_a, "convective_share"_a)
      .def("ignite", &BurningFloor::Ignite, "cell"_a)
      .def("set_door", &BurningFloor::SetDoor, "door"_a, "closed"_a)
      .def("advance", &BurningFloor::Advance, "seconds"_a)
      .def("is_burnt_through", &BurningFloor::IsBurntThrough, "door"_a)
      .def_prop_ro("heat_release_kw", [](const BurningFloor& floor) { return floor.fire().heat_release_kw(); })
      .def("states", [](const BurningFloor& floor) { return OfCells<std::uint8_t>(floor, floor.States()); })
      .def("soot_g_m2", [](const BurningFloor& floor) { return OfCells<double>(floor, floor.Soot()); })
      .def(
          "soot_g_m3",
          [](const BurningFloor& floor, double height_m) { return OfCells<float>(floor, floor.SootDensity(height_m)); },
          "height_m"_a)
      .def(
          "temperature_c",
          [](const BurningFloor& floor, float ambient_c, float flame_c) {
            return OfCells<float>(floor, floor.Temperature(ambient_c, flame_c));
          },
          "ambient_c"_a, "flame_c"_a);
}

}  // namespace

void BindHazards(nb::module_&& m) {
  BindBurningFloor(m);
  nb::class_<hazards::Haze>(m, "Haze").def(
      "__init__",
      [](hazards::Haze* self, const base::Point& origin_m, double resolution_m, const Values& soot_g_m3,
         double extinction_m2_g, double limit) {
        new (self) hazards::Haze(ShapeOf(soot_g_m3, origin_m, resolution_m), ValuesOf<float>(soot_g_m3),
                                 extinction_m2_g, limit);
      },
      "origin_m"_a, "resolution_m"_a, "soot_g_m3"_a, "extinction_m2_g"_a, "limit"_a);
  m.def(
      "values_at",
      [](const Values& values, const base::Point& origin_m, double resolution_m, const Points& positions_m,
         double outside) {
        return ArrayOf(hazards::ValuesAt({ShapeOf(values, origin_m, resolution_m), values.data()},
                                         RecordsOf<base::Point>(positions_m), outside));
      },
      "values"_a, "origin_m"_a, "resolution_m"_a, "positions_m"_a, "outside"_a);
  m.def(
      "hot_in_sight",
      [](const Values& temperatures_c, const base::Point& origin_m, double resolution_m, double limit_c,
         const plan::PlanningGrid& sight, const base::Point& place_m, double range_m) {
        return hazards::HotInSight({ShapeOf(temperatures_c, origin_m, resolution_m), temperatures_c.data()}, limit_c,
                                   sight, place_m, range_m);
      },
      "temperatures_c"_a, "origin_m"_a, "resolution_m"_a, "limit_c"_a, "sight"_a, "place_m"_a, "range_m"_a);
}

}  // namespace robotteamsim::bindings
