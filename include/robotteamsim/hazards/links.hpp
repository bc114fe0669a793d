#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::hazards {

/// The place where a door's leaf crosses the line between the centres of two neighbouring cells.
struct Crossing {
  int door = 0;
  int cell = 0;         ///< row * cols + column
  bool is_east = true;  ///< between the cell and its eastern neighbour; else its northern one
};

/// The links between neighbouring cells through which air flows and fire spreads: 1 open, 0 a wall. A link through a
/// doorway carries its share of the doorway's width, in cells.
///
/// Any line of neighbouring cells from one room to another crosses what separates the rooms, so walls are tight at any
/// resolution. The arrays have a border of one cell without links, which saves the loops all special cases.
class Links {
 public:
  /// Args: east, north: rows * cols values, 0 where a wall is between a cell and its eastern or northern neighbour.
  /// Throws std::invalid_argument: a size or a crossing is wrong.
  Links(int rows, int cols, const std::vector<std::uint8_t>& east, const std::vector<std::uint8_t>& north,
        std::vector<Crossing> crossings, int doors);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  int doors() const { return static_cast<int>(doors_.size()); }
  int stride() const { return cols_ + 2; }
  /// Returns the index in the arrays with a border.
  int Padded(int cell) const { return (cell / cols_ + 1) * stride() + cell % cols_ + 1; }
  int PaddedSize() const { return (rows_ + 2) * stride(); }

  const std::vector<float>& east() const { return east_; }
  const std::vector<float>& north() const { return north_; }
  const std::vector<Crossing>& crossings() const { return crossings_; }

  /// Sets which share of the air of a link passes each link through a door, and whether fire passes.
  /// Throws std::invalid_argument: the share is below 0 or above 2.
  void SetDoor(int door, double share, bool passes_fire);

  /// Returns whether fire spreads from a cell to its neighbour in a direction: 0 east, 1 north, 2 west, 3 south.
  bool IsOpen(int padded, int direction) const;

  /// The largest sum of the shares of two opposite links of a cell; at least 2, as without doors.
  double LargestPair() const { return largest_pair_; }

 private:
  struct DoorState {
    float share = 1.0F;
    bool passes_fire = true;
  };

  void Update();

  int rows_;
  int cols_;
  std::vector<float> open_east_;  ///< without doors
  std::vector<float> open_north_;
  std::vector<float> east_;
  std::vector<float> north_;
  std::vector<Crossing> crossings_;
  std::vector<std::uint8_t> passes_east_;
  std::vector<std::uint8_t> passes_north_;
  std::vector<DoorState> doors_;
  double largest_pair_ = 2.0;
};

}  // namespace robotteamsim::hazards
