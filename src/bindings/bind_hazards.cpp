// _core.hazards: fire, smoke and heat.
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "geometry.hpp"
#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/hazards/burning_floor.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace nb = nanobind;
using namespace nb::literals;

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

/// The values of all cells without the border, as an array of rows.
template <typename To, typename Function>
Array<To, -1, -1> CellsOf(const hazards::Links& links, const Function& value_of) {
  const int rows = links.rows(), cols = links.cols();
  auto cells = NewArray<To, -1, -1>({static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
  To* __restrict to = cells.data();
  for (int row = 1; row <= rows; ++row, to += cols) {
    const int begin = row * links.stride() + 1;
    for (int col = 0; col < cols; ++col) to[col] = value_of(begin + col);
  }
  return cells;
}

Array<float, -1, -1> SootOf(const hazards::BurningFloor& floor, double height_m) {
  base::CheckPositive(height_m, "height_m");
  const double* const soot = floor.air().soot().data();
  const double share = 1.0 / height_m;
  return CellsOf<float>(floor.links(), [=](int i) { return static_cast<float>(soot[i] * share); });
}

Array<float, -1, -1> TemperatureOf(const hazards::BurningFloor& floor, float ambient_c, float flame_c) {
  base::Check(ambient_c, "ambient_c");
  base::Check(flame_c, "flame_c");
  const float* const excess = floor.air().excess().data();
  auto cells = CellsOf<float>(floor.links(), [=](int i) { return ambient_c + excess[i]; });
  for (const hazards::Release& release : floor.fire().releases()) {
    const int padded = release.padded, stride = floor.links().stride();
    if (floor.fire().states()[padded] != hazards::Burning::kBurns) continue;
    float& cell = cells.data()[(padded / stride - 1) * floor.links().cols() + padded % stride - 1];
    cell = std::max(cell, flame_c);
  }
  return cells;
}

// The values of the cells that contain some points; `outside` where there is none, also for NaN.
Array<double, -1> ValuesAt(const Array<const float, -1, -1>& values, const base::Point& origin_m, double resolution_m,
                           const Points& positions_m, double outside) {
  base::Check(origin_m, "origin_m");
  base::CheckPositive(resolution_m, "resolution_m");
  base::Check(outside, "outside");
  auto found = NewArray<double, -1>({positions_m.shape(0)});
  const auto rows = static_cast<double>(values.shape(0)), cols = static_cast<double>(values.shape(1));
  for (std::size_t i = 0; i < positions_m.shape(0); ++i) {
    const double col = std::floor((positions_m.data()[2 * i] - origin_m.x) / resolution_m);
    const double row = std::floor((positions_m.data()[2 * i + 1] - origin_m.y) / resolution_m);
    const bool is_inside = col >= 0.0 && col < cols && row >= 0.0 && row < rows;
    found.data()[i] =
        is_inside ? values.data()[static_cast<std::size_t>(row) * values.shape(1) + static_cast<std::size_t>(col)]
                  : outside;
    if (!std::isfinite(found.data()[i])) throw std::invalid_argument("values must be finite");
  }
  return found;
}

// The centres of the cells as hot as a limit within a range of a place, to which the straight line is free.
std::vector<base::Point> HotInSight(const Array<const float, -1, -1>& temperatures_c, const base::Point& origin_m,
                                    double resolution_m, double limit_c, const plan::PlanningGrid& sight,
                                    const base::Point& place_m, double range_m) {
  base::Check(origin_m, "origin_m");
  base::CheckPositive(resolution_m, "resolution_m");
  base::Check(place_m, "place_m");
  base::CheckNotNegative(range_m, "range_m");
  std::vector<base::Point> found;
  const auto index = [&](double offset, std::size_t count) {
    return base::ClampedInt(std::floor(offset / resolution_m), 0, static_cast<int>(count) - 1);
  };
  const std::size_t rows = temperatures_c.shape(0), cols = temperatures_c.shape(1);
  if (rows == 0 || cols == 0) return found;
  const int last_row = index(place_m.y + range_m - origin_m.y, rows);
  const int first_col = index(place_m.x - range_m - origin_m.x, cols);
  const int last_col = index(place_m.x + range_m - origin_m.x, cols);
  for (int row = index(place_m.y - range_m - origin_m.y, rows); row <= last_row; ++row) {
    for (int col = first_col; col <= last_col; ++col) {
      if (!(temperatures_c.data()[static_cast<std::size_t>(row) * cols + col] >= limit_c)) continue;
      const base::Point hot{origin_m.x + (col + 0.5) * resolution_m, origin_m.y + (row + 0.5) * resolution_m};
      const double x = hot.x - place_m.x, y = hot.y - place_m.y;
      if (x * x + y * y <= range_m * range_m && sight.IsLineFree(place_m, hot)) found.push_back(hot);
    }
  }
  return found;
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
      .def("states",
           [](const Floor& floor) {
             const hazards::Links& links = floor.links();
             const auto rows = static_cast<std::size_t>(links.rows()), cols = static_cast<std::size_t>(links.cols());
             auto cells = NewArray<std::uint8_t, -1, -1>({rows, cols});
             for (std::size_t row = 0; row < rows; ++row) {
               std::memcpy(cells.data() + row * cols,
                           floor.fire().states().data() + links.Padded(static_cast<int>(row * cols)), cols);
             }
             return cells;
           })
      .def("soot_g_m2",
           [](const Floor& floor) {
             return CellsOf<double>(floor.links(), [&](int i) { return floor.air().soot()[i]; });
           })
      .def("soot_g_m3", &SootOf, "height_m"_a)
      .def("temperature_c", &TemperatureOf, "ambient_c"_a, "flame_c"_a);
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

void BindHazards(nb::module_& m) {
  BindBurningFloor(m);
  BindHaze(m);
  m.def("values_at", &ValuesAt, "values"_a, "origin_m"_a, "resolution_m"_a, "positions_m"_a, "outside"_a);
  m.def("hot_in_sight", &HotInSight, "temperatures_c"_a, "origin_m"_a, "resolution_m"_a, "limit_c"_a, "sight"_a,
        "place_m"_a, "range_m"_a);
}

}  // namespace robotteamsim::bindings
