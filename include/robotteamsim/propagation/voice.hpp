#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"

namespace robotteamsim::propagation {

/// The fading of a call for help [dissertation, eq. 7]. The unit of the faces is half a wall for eq. (6), or half a
/// millimetre of thickness for eq. (5).
struct VoiceModel {
  double noise_db = 0.0;        ///< background noise: weaker voices are not heard
  double unit_db = 0.0;         ///< loss per unit of the faces
  double min_distance_m = 0.0;  ///< lower limit of distances
};

/// One calling victim.
struct VoiceSource {
  base::Point position;
  double constant_db = 0.0;  ///< l_c, negative
  double exponent = 0.0;     ///< gamma
};

/// Whether a cell is solid, one matrix row per row of cells.
using SolidCells = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns -l_c - 10 gamma log10(d) - walls of eq. (7) [dB], regardless of the noise.
double VoiceLevelDb(const FaceSet& faces, const VoiceModel& model, const VoiceSource& source, PointMm at);

/// Writes the highest level of all sources at the centre of every cell [dB]; 0 below the noise and in solid cells.
/// Throws std::invalid_argument if `solid` or `map` does not fit the grid.
void WriteVoiceMap(const FaceSet& faces, const VoiceModel& model, const std::vector<VoiceSource>& sources,
                   const plan::GridShape& grid, const Eigen::Ref<const SolidCells>& solid, MapView map,
                   const MapWork& work = {});

/// A cell and its value.
struct Cell {
  int row = 0;
  int col = 0;
  double value = 0.0;
};

/// Returns the cell with the highest value above 0 of those whose centre is within a radius [m] of a point; of equal
/// cells the lowest row, then the lowest column. Nothing if no such cell is above 0.
/// Args: guess: a cell that may be the result, such as that of a nearby point: it only speeds up the search.
std::optional<Cell> LoudestCell(const plan::GridShape& grid, const Eigen::Ref<const MapValues>& values,
                                const base::Point& at, double radius_m,
                                const std::optional<Cell>& guess = std::nullopt);

}  // namespace robotteamsim::propagation
