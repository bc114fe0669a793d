#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid_shape.hpp"

namespace robotteamsim::plan {

/// A way between two places that does not lead over the grid, such as a lift, in both directions.
struct Portal {
  base::Point a;
  base::Point b;
  double length_m = 0.0;  ///< at most kLongestPortal cells
};
constexpr double kLongestPortal = 1e6;

/// The cells that are free for the centre of one robot, and the paths through them, also by portals.
///
/// Paths are 8-connected and never cut a corner: a diagonal step needs both cells beside it free. Of equally long paths
/// the cell index decides, so that results are deterministic. Nothing is free beyond the grid.
class PlanningGrid {
 public:
  /// A place and its value.
  struct Valued {
    base::Point place;
    double value;
  };

  /// Blocks every cell whose centre is nearer than `inflation_m` to an occupied cell (nonzero in `occupied`).
  /// Args: portals: those with an end in a blocked cell are left out.
  PlanningGrid(const GridShape& shape, const std::vector<std::uint8_t>& occupied, double inflation_m,
               const std::vector<Portal>& portals = {});

  const GridShape& shape() const { return shape_; }
  const std::vector<Portal>& portals() const { return portals_; }
  const std::vector<std::uint8_t>& blocked() const { return blocked_; }

  bool IsFree(const base::Point& point) const;

  /// Returns the centre of the free cell nearest to `point`, or `point` itself if it is free; nothing if no cell within
  /// `max_distance_m` is free.
  std::optional<base::Point> NearestFree(const base::Point& point, double max_distance_m) const;

  /// Returns whether the segment crosses only free cells; at a cell corner, both cells beside it count.
  bool IsLineFree(const base::Point& a, const base::Point& b) const;

  /// Returns the length of the shortest path from every cell to `goal` [m]; infinity if there is none or the cell is
  /// blocked.
  std::vector<float> DistanceMap(const base::Point& goal) const;

  /// Returns the value of `distances` (a DistanceMap of `size` cells) in the cell of a point; infinity beyond the grid.
  double ValueAt(const float* distances, std::size_t size, const base::Point& point) const;

  /// Returns the place up to `look_ahead_m` down the steepest descent of `distances` (a DistanceMap) to which the
  /// straight line from `from` is free: where to walk next on the shortest path. Nothing if there is no path.
  std::optional<base::Point> Descend(const float* distances, std::size_t size, const base::Point& from,
                                     double look_ahead_m) const;

  /// Returns the cell centres of a shortest path, the cells of `from` and `to` included (A*). Empty if an end is
  /// blocked or no path of at most `max_length_m` exists.
  std::vector<base::Point> ShortestPath(const base::Point& from, const base::Point& to, double max_length_m) const;

  /// Returns the corners that remain of a path when every stretch with free line of sight becomes straight.
  std::vector<base::Point> Shortcut(const std::vector<base::Point>& path) const;

  /// Returns the corners of a shortest path, its ends included: the Shortcut of ShortestPath.
  std::vector<base::Point> Waypoints(const base::Point& from, const base::Point& to, double max_length_m) const {
    return Shortcut(ShortestPath(from, to, max_length_m));
  }

  /// Returns, of the cells within `radius_m` of `from` that can be reached from it inside that disc, the centre of
  /// the cell with the least value of `distances` (a DistanceMap); nothing if `from` is blocked or all are infinite.
  std::optional<Valued> LeastReachable(const float* distances, std::size_t size, const base::Point& from,
                                       double radius_m) const;

  /// Returns, of the same cells, the centre of the cell nearest to `to`; nothing if `from` is blocked.
  std::optional<base::Point> NearestReachable(const base::Point& from, const base::Point& to, double radius_m) const;

  /// Returns `goal` if the straight path to it is free; else the place nearest to it that can be reached close by.
  base::Point ReachableTowards(const base::Point& from, const base::Point& goal) const;

  /// Returns the first bend of a shortest path and the length of the whole path [m]. The bend is `goal` itself, at its
  /// straight distance, if the straight path is free or no path of at most `max_length_m` exists.
  Valued FirstStretch(const base::Point& from, const base::Point& goal, double max_length_m) const;

  /// Returns a point at the length of the path to `goal`, in the direction of its first stretch.
  base::Point AlongPath(const base::Point& from, const base::Point& goal, double max_length_m) const;

  /// Returns, of all free cells within `radius_m` of `center`, the centre of the cell with the least straight
  /// distance to `to`.
  std::optional<base::Point> NearestInDisc(const base::Point& center, const base::Point& to, double radius_m) const;

 private:
  struct Step {
    int offset;
    int d_row;
    int d_col;
    double length_m;
  };

  struct Cell {
    int index;
    int row;
    int col;
  };

  /// A portal in one direction.
  struct Jump {
    Cell from;
    Cell to;
    double length_m;
  };

  bool Inside(int row, int col) const { return row >= 0 && row < shape_.rows && col >= 0 && col < shape_.cols; }
  bool Free(int row, int col) const { return Inside(row, col) && blocked_[row * shape_.cols + col] == 0; }
  void FindExits();
  int RowOf(double y) const;
  int ColOf(double x) const;
  int FreeCellOf(const base::Point& point) const;
  Cell CellAt(int index) const;
  base::Point Center(int row, int col) const;
  base::Point Center(int cell) const;
  template <typename Visit>
  void ForJumpsFrom(int cell, const Visit& visit) const;
  double LeastOnGrid(const Cell& from, const Cell& to) const;
  std::vector<double> LeastFromJumps(const Cell& goal) const;
  template <typename Value>
  std::optional<Valued> BestReachable(const base::Point& from, double radius_m, const Value& value) const;

  GridShape shape_;
  std::vector<std::uint8_t> blocked_;
  std::array<Step, 8> steps_{};
  std::vector<Portal> portals_;
  std::vector<Jump> jumps_;             ///< in the order of their cells
  std::vector<std::uint8_t> has_jump_;  ///< whether a portal begins in this cell; empty without portals
  std::vector<std::uint8_t> exits_;     ///< bit i: step i leads from this free cell to a free cell and cuts no corner
};

}  // namespace robotteamsim::plan
