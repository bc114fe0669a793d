#include "robotteamsim/control/unknown_in_view.hpp"

#include <cstddef>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/maps/occupancy_grid.hpp"

namespace robotteamsim::control {

std::vector<double> UnknownInView(const base::Table<const std::int8_t>& cells, const std::vector<RowAndCol>& from,
                                  const base::Table<const RowAndCol>& rays, const std::vector<double>& areas_m2) {
  if (rays.cols != areas_m2.size()) throw std::invalid_argument("there must be one area per cell of a ray");
  for (const double area_m2 : areas_m2) base::CheckNotNegative(area_m2, "an area");
  std::vector<double> seen_m2;
  seen_m2.reserve(from.size());
  for (const RowAndCol& place : from) {
    double sum_m2 = 0.0;
    for (std::size_t ray = 0; ray < rays.rows; ++ray) {
      const RowAndCol* offsets = rays.Row(ray);
      for (std::size_t i = 0; i < rays.cols; ++i) {
        const std::int64_t row = std::int64_t{place.row} + offsets[i].row,
                           col = std::int64_t{place.col} + offsets[i].col;
        if (row < 0 || row >= static_cast<std::int64_t>(cells.rows)) break;
        if (col < 0 || col >= static_cast<std::int64_t>(cells.cols)) break;
        const std::int8_t cell = cells.Row(row)[col];
        if (cell == maps::kOccupied) break;
        if (cell == maps::kUnknown) sum_m2 += areas_m2[i];
      }
    }
    seen_m2.push_back(sum_m2);
  }
  return seen_m2;
}

}  // namespace robotteamsim::control
