#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::control {

/// A disc that a robot keeps out of [m].
struct KeptOut {
  base::Point center;
  double radius_m = 0.0;
};

/// The way of a robot over a grid of cells: its cells, the robot's own one first, and where to drive now [m].
struct CellWay {
  std::vector<int> cells;
  base::Point ahead;
};

/// Paths between the cells of a coarse grid: a graph over the fine grid in which robots drive.
///
/// Each cell has one free place, if it has any. Neighbours are linked if the fine grid has a short path between their
/// places, and the cells at the ends of a portal. Lengths from a cell are computed when they are first asked for: use
/// one object per thread.
class CellPaths {
 public:
  static constexpr int kNone = -1;

  /// Args: cells: the coarse grid.  kept_out: no path enters this disc; nothing if there is none.
  /// Throws std::invalid_argument if the grid has no cell or too many, or a number cannot be used.
  CellPaths(std::shared_ptr<const plan::PlanningGrid> fine, const plan::GridShape& cells,
            const std::optional<KeptOut>& kept_out);

  std::size_t Size() const { return places_.size(); }
  const plan::GridShape& cells() const { return cells_; }

  /// Returns the cell that contains a point; the nearest one for a point beyond the grid.
  int CellOf(const base::Point& point) const;

  /// Returns the cell nearest to a point, of those around it, whose place is linked to others and has a short path from
  /// the point; kNone without one.
  int StartOf(const base::Point& point) const;

  /// Returns the free place of a cell [m]; nothing if it has none.
  /// Throws std::invalid_argument if there is no such cell.
  const std::optional<base::Point>& PlaceOf(int cell) const;

  /// Returns the lengths of the shortest paths from one cell's place to all others [m]; infinity where there is none.
  /// Throws std::invalid_argument if there is no such cell.
  const std::vector<float>& LengthsFrom(int cell) const;

  /// Returns one of these lengths.
  float LengthBetween(int from, int to) const;

  /// Returns the farthest place on the path to a cell to which the straight line from a position is free, at most
  /// `longest_m` of path ahead; if none is, the next one. Nothing without a path.
  std::optional<base::Point> Ahead(const base::Point& position, int goal, double longest_m) const;

  /// Returns the shortest way from a position to the nearest of the goals over allowed cells only, to which the robot's
  /// own cell need not belong; nothing if there is none. `ahead` is the farthest of its places, within `longest_m`, to
  /// which a straight line is free and crosses only allowed cells; if none is, the next one.
  /// Throws std::invalid_argument if there is not one value per cell.
  std::optional<CellWay> WayWithin(const base::Point& position, const std::vector<std::uint8_t>& goals,
                                   const std::vector<std::uint8_t>& allowed, double longest_m) const;

 private:
  static constexpr int kNeighbours = 8;

  /// The way from one cell to another through a portal of the fine grid.
  struct Jump {
    int from;
    int to;
    float length;
  };

  void FindPlaces();
  void Link(int row, int col);
  void LinkPortals();
  template <typename Visit>
  void ForJumpsFrom(int cell, const Visit& visit) const;
  std::vector<int> ShortestWithin(int from, const std::vector<std::uint8_t>& goals,
                                  const std::vector<std::uint8_t>& allowed) const;
  bool IsLineWithin(const base::Point& from, const base::Point& to, const std::vector<std::uint8_t>& allowed) const;
  bool IsInSight(const base::Point& from, int cell) const;
  bool IsLinked(int cell) const;
  void CheckCell(int cell) const;
  bool IsAllowed(const base::Point& a, const base::Point& b) const;

  std::shared_ptr<const plan::PlanningGrid> fine_;
  plan::GridShape cells_;
  std::optional<KeptOut> kept_out_;
  std::vector<std::optional<base::Point>> places_;
  std::vector<std::array<float, kNeighbours>> links_;  ///< lengths to the neighbours [m]; infinite if not linked
  std::vector<Jump> jumps_;                            ///< in the order of their cells
  std::vector<std::uint8_t> has_jump_;                 ///< whether a portal begins in this cell; empty without portals
  mutable std::vector<std::vector<float>> lengths_;
};

}  // namespace robotteamsim::control
