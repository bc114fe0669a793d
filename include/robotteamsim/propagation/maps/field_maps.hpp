#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/fading.hpp"
#include "robotteamsim/propagation/maps/row_kernels.hpp"

namespace robotteamsim::propagation {

/// The source of a signal and its fading.
struct FieldSource {
  PointMm position;
  Fading fading;
  std::vector<double> floors_db{};  ///< the loss of 0, 1, 2, ... floors without a weight; as many as a ray can cross
};

/// The value of cells that lie on no storey of a building that has storeys [dB].
constexpr float kNothingDb = -1000.0F;

/// How to compute maps; no value from `least_db` on depends on it.
struct MapWork {
  int threads = 1;  ///< 0: one per core
  base::Simd simd = base::BestSimd();
  float least_db = -std::numeric_limits<float>::infinity();  ///< lower values may be any lower ones
};

/// A map to be written, one row per row of cells.
using MapView = Eigen::Ref<MapValues>;

/// Throws std::invalid_argument if a map does not have `rows` and `cols`.
void CheckShape(const MapView& map, Eigen::Index rows, Eigen::Index cols);

/// Writes, per cell, the highest value of all sources at its centre, walls included.
/// Throws std::invalid_argument if there is no source or `map` does not fit the grid.
void WriteHighest(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid,
                  MapView map, const MapWork& work = {});

/// Writes one map per source, one below the other: `maps` has rows * sources.size() rows. Throws as WriteHighest.
void WriteEach(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid, MapView maps,
               const MapWork& work = {});

/// Returns FaceSet::WeightBetween a source and the centre of each cell of a grid, row by row.
std::vector<std::int32_t> WeightsFrom(const FaceSet& faces, PointMm source, const plan::GridShape& grid);

}  // namespace robotteamsim::propagation
