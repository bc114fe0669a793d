#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "robotteamsim/plan/grid.hpp"
#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim::control {

/// How voices fade on their way, as far as a robot knows.
struct AssumedFading {
  double slope_db = 0.0;        ///< 10 gamma of a middling voice
  double wall_unit_db = 0.0;    ///< loss per unit of the faces
  double min_distance_m = 0.0;  ///< lower limit of distances
  double nearer_m = 0.0;        ///< a robot also hears places that are this much nearer to the victim
  double step_db = 0.0;         ///< unit of the losses below
};

/// The loss of a voice on the way from each cell of a grid to each other, in steps of `step_db`, rounded up.
///
/// A row is computed when it is first asked for: use one object per thread. Losses are symmetric. Cells on different
/// storeys do not hear each other: floors cost more than most walls, and openings are few.
class VoiceLosses {
 public:
  static constexpr int kMostCells = 1 << 16;
  static constexpr std::uint8_t kSilent = 255;  ///< the largest loss stands for all that are as large or larger

  /// Throws std::invalid_argument if the grid has no cell or too many, or a number cannot be used.
  VoiceLosses(propagation::FaceSet faces, const plan::GridShape& grid, const AssumedFading& fading);

  const plan::GridShape& grid() const { return grid_; }
  const AssumedFading& fading() const { return fading_; }
  std::size_t Size() const { return rows_.size(); }

  /// Returns the losses from one cell to all cells. Throws std::invalid_argument if there is no such cell.
  const std::vector<std::uint8_t>& From(int cell) const;

  /// Returns the loss between cells that are so many rows and columns apart, if no wall is between them: no loss at
  /// this distance is smaller. Both numbers must be from 0 to below those of the grid.
  std::uint8_t WithoutWalls(int rows, int cols) const;

  /// Returns the largest number of rows or columns between two cells whose loss is below some steps.
  int ReachOf(int steps) const;

  /// Returns the loss of the walls alone between a place and the centre of each cell [dB].
  std::vector<float> WallsFromDb(const base::Point& place) const;

 private:
  propagation::FaceSet faces_;
  plan::GridShape grid_;
  AssumedFading fading_;
  /// Loss over the distance of cells that are (row, col) apart, row by row, col from 1 - cols to cols - 1 [dB].
  std::vector<float> over_distance_;
  mutable std::vector<std::vector<std::uint8_t>> rows_;
};

}  // namespace robotteamsim::control
