// The plain way to compute a map: one ray and one logarithm per cell.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/fading.hpp"

namespace robotteamsim::propagation::reference {

/// Returns the weight between the source and the centre of a cell.
inline std::int64_t Weight(const FaceSet& faces, PointMm source, const CellCentersMm& cells, int row, int col) {
  return faces.WeightBetween(source, cells.At(row, col));
}

/// Returns the value of a signal at a point, behind walls of some weight.
inline double ValueBehind(std::int64_t weight, PointMm source, const Fading& fading, PointMm at) {
  const double distance_m = std::max(DistanceM(source, at), fading.min_distance_m);
  return fading.constant_db - fading.slope_db * std::log10(distance_m) - fading.unit_db * static_cast<double>(weight);
}

/// Returns the value of a signal at the centre of a cell.
inline double Value(const FaceSet& faces, PointMm source, const Fading& fading, const CellCentersMm& cells, int row,
                    int col) {
  return ValueBehind(Weight(faces, source, cells, row, col), source, fading, cells.At(row, col));
}

/// Returns the map of one source.
inline CellValues Map(const FaceSet& faces, PointMm source, const Fading& fading, const plan::GridShape& grid) {
  const CellCentersMm cells(grid);
  CellValues values(grid.rows, grid.cols);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) values(row, col) = Value(faces, source, fading, cells, row, col);
  }
  return values;
}

}  // namespace robotteamsim::propagation::reference
