#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/base/table.hpp"

namespace robotteamsim::control {

/// A cell of a grid, or how far it is from another one, in rows and columns.
struct RowAndCol {
  std::int32_t row = 0;
  std::int32_t col = 0;
};

/// Returns the unknown floor that may be seen from some cells along rays, which end before walls and at the border.
/// Args: cells:    kFree, kOccupied or kUnknown, row by row.
///       rays:     one per row: the offsets of the cells that it crosses, outwards.
///       areas_m2: the floor for which each cell of a ray counts [m^2].
/// Throws std::invalid_argument if rays do not have one area per cell, or an area is negative or not finite.
std::vector<double> UnknownInView(const base::Table<const std::int8_t>& cells, const std::vector<RowAndCol>& from,
                                  const base::Table<const RowAndCol>& rays, const std::vector<double>& areas_m2);

}  // namespace robotteamsim::control
