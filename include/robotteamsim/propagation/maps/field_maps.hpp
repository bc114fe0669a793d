#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/fading.hpp"
#include "robotteamsim/propagation/maps/row_kernels.hpp"

namespace robotteamsim::propagation {

/// Where a signal comes from, and how it fades.
struct FieldSource {
  PointMm position;
  Fading fading;
};

/// How to compute maps; neither changes a value.
struct MapWork {
  int threads = 1;  ///< 0 for as many as the machine has
  base::Simd simd = base::BestSimd();
};

/// A map to be written, one row per row of cells.
using MapView = Eigen::Ref<MapValues>;

/// Throws std::invalid_argument where a map does not have `rows` and `cols`.
void CheckShape(const MapView& map, Eigen::Index rows, Eigen::Index cols);

/// Writes, per cell, the highest of the values that the sources have at its centre, walls and all.
/// Throws std::invalid_argument where there is no source, and where `map` does not fit the grid.
void WriteHighest(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid,
                  MapView map, const MapWork& work = {});

/// Writes one map per source, one below the other: `maps` has rows * sources.size() rows. Throws as WriteHighest.
void WriteEach(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid, MapView maps,
               const MapWork& work = {});

/// What the walls between one source and every cell weigh, kept up to date as doors open and close.
class WeightMap {
 public:
  WeightMap(const FaceSet& faces, PointMm source, const plan::GridShape& grid, const MapWork& work = {});

  PointMm Source() const { return source_; }
  const CellCentersMm& Cells() const { return cells_; }

  /// Adds or takes away the shadow of each face that has become active, or ceased to be, since the last call. Doors
  /// opened and closed again leave the map as it was, to the bit.
  /// Args: faces: those of the constructor.
  void Update(const FaceSet& faces);

  /// Returns FaceSet::WeightBetween the source and the centre of a cell.
  std::int32_t At(int row, int col) const;

  /// Writes the values of a signal from the source. Throws std::invalid_argument where `map` does not fit the grid.
  void WriteValues(const Fading& fading, MapView map) const;

 private:
  template <typename Weight>
  void Fill(const FaceSet& faces, std::vector<Weight>* weights);
  template <typename Weight>
  void AddShadow(const Face& face, std::int32_t change, std::vector<Weight>* weights);

  PointMm source_;
  CellCentersMm cells_;
  base::Simd simd_;
  std::vector<std::int32_t> face_weights_;  // as they are in the map
  // One of the two, row by row; the narrow one where no sum can leave it.
  std::vector<std::int16_t> narrow_;
  std::vector<std::int32_t> wide_;
};

}  // namespace robotteamsim::propagation
