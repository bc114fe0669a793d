#pragma once

#include <Eigen/Core>
#include <cstdint>
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
};

/// How to compute maps; no value depends on it.
struct MapWork {
  int threads = 1;  ///< 0: one per core
  base::Simd simd = base::BestSimd();
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

/// The weights of the walls between one source and every cell, updated as doors open and close.
class WeightMap {
 public:
  WeightMap(const FaceSet& faces, PointMm source, const plan::GridShape& grid, const MapWork& work = {});

  PointMm Source() const { return source_; }
  const CellCentersMm& Cells() const { return cells_; }

  /// Adds or removes the shadow of each face that was activated or deactivated since the last call. A door that opens
  /// and closes again leaves the map as it was, to the bit.
  /// Args: faces: those of the constructor.
  void Update(const FaceSet& faces);

  /// Returns FaceSet::WeightBetween the source and the centre of a cell.
  std::int32_t At(int row, int col) const;

  /// Writes the values of a signal of the source. Throws std::invalid_argument if `map` does not fit the grid.
  void WriteValues(const Fading& fading, MapView map) const;

 private:
  template <typename Weight>
  void Fill(const FaceSet& faces, std::vector<Weight>* weights);
  template <typename Weight>
  void AddShadow(const Face& face, std::int32_t change, std::vector<Weight>* weights);

  PointMm source_;
  CellCentersMm cells_;
  base::Simd simd_;
  std::vector<std::int32_t> face_weights_;  // those in the map
  // One of the two, row by row; the narrow one if all sums fit it.
  std::vector<std::int16_t> narrow_;
  std::vector<std::int32_t> wide_;
};

}  // namespace robotteamsim::propagation
