#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/field_maps.hpp"

namespace robotteamsim::propagation {

/// How a call for help fades [dissertation, eq. 7]; the walls are in the faces, in units that they share with the
/// model: half walls of eq. (6), or halves of a millimetre of thickness for eq. (5).
struct VoiceModel {
  double noise_db = 0.0;        ///< background noise: a weaker voice is not heard
  double unit_db = 0.0;         ///< what one unit of weight of the faces costs
  double min_distance_m = 0.0;  ///< distances below count as this
};

/// One calling victim.
struct VoiceSource {
  base::Point position;
  double constant_db = 0.0;  ///< l_c, negative
  double exponent = 0.0;     ///< gamma
};

/// Whether a cell is solid, one matrix row per row of cells.
using SolidCells = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns -l_c - 10 gamma log10(d) - walls of eq. (7) [dB], whatever the noise.
double VoiceLevelDb(const FaceSet& faces, const VoiceModel& model, const VoiceSource& source, PointMm at);

/// Writes the highest level of all sources at the centre of every cell [dB]; 0 where it is below the noise, and in
/// solid cells. Throws std::invalid_argument where `solid` or `map` does not fit the grid.
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
/// ones the lowest row, then the lowest column. Nothing where no such cell is above 0.
/// Args: guess: a cell of the grid that may be it, as the one that was found nearby: the same is found, but sooner.
std::optional<Cell> LoudestCell(const plan::GridShape& grid, const Eigen::Ref<const MapValues>& values,
                                const base::Point& at, double radius_m,
                                const std::optional<Cell>& guess = std::nullopt);

}  // namespace robotteamsim::propagation
