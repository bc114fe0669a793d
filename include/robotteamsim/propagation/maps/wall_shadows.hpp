#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/propagation/cells.hpp"
#include "robotteamsim/propagation/face_set.hpp"
#include "robotteamsim/propagation/maps/grid_line.hpp"

namespace robotteamsim::propagation {

/// The weights of the walls between a source and the cells of a grid, as changes from each cell to the cell above it.
///
/// A face shades the region beyond it, between the rays through its two ends. Up a column of cells, the weight changes
/// only at such a ray or at a face. All faces that end in one vertex share its ray, so their changes add up; at most
/// vertices of a wall they cancel. This leaves a short list of straight lines, each with one change of weight, and the
/// weights of the lowest row. ShadowSweep writes them to the map.
///
/// Ties are broken as in FaceSet, by shifting all faces by (eps, eps^2): every weight is equal to
/// FaceSet::WeightBetween.
class WallShadows {
 public:
  /// Throws std::invalid_argument if the sum of all weights is above 5e8.
  WallShadows(const FaceSet& faces, PointMm source, const CellCentersMm& cells);

 private:
  friend class ShadowSweep;

  /// A line in columns [first, last), with the change of weight in the first row beyond it.
  struct Change {
    SteppedLine rows;
    int first = 0;
    int last = 0;
    std::int32_t weight = 0;
  };

  /// Computes the weights of the lowest row: that of its first cell and the changes along the row.
  void FillLowestRow(const FaceSet& faces, PointMm source, const CellCentersMm& cells,
                     const std::vector<std::int32_t>& turns);
  void AddRays(const FaceSet& faces, PointMm source, const CellCentersMm& cells,
               const std::vector<std::int32_t>& turns);
  void AddFaces(const FaceSet& faces, PointMm source, const CellCentersMm& cells);
  void AddLine(const GridLine& line, const CellCentersMm& cells, IndexRange columns, std::int32_t weight);

  std::vector<std::int32_t> lowest_row_;
  std::vector<Change> changes_;  // one per column of a line that fixed-point steps do not follow exactly
};

/// Sweeps up some columns of a map and writes the changes of the weights.
class ShadowSweep {
 public:
  /// Args: shadows: must outlive the sweep.
  ShadowSweep(const WallShadows& shadows, IndexRange columns);

  /// Adds to a block of zeros the change of weight from each cell to the one above it (in the map's lowest row, the
  /// weight itself) for the next rows. The sums up each column are the weights.
  /// Args: rows: from 0, or from where the last call ended; block: its first value is that of the first row and column,
  ///       its rows are `stride` values apart. Weight: std::int16_t or std::int32_t, as wide as the sums need.
  template <typename Weight>
  void AddChanges(IndexRange rows, Weight* block, std::ptrdiff_t stride);

 private:
  /// A line from its lowest row upward: column `col`, then to the right (direction 1) or left (-1).
  struct Line {
    std::int64_t position = 0;  // of SteppedLine
    std::int64_t step = 0;      // >= 0
    std::int64_t end = 0;       // position beyond the last column
    int col = 0;
    int direction = 0;
    std::int32_t weight = 0;
  };
  const std::int32_t* lowest_row_;
  int width_;
  std::vector<Line> lines_;
};

}  // namespace robotteamsim::propagation
