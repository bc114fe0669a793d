#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/maps/occupancy_grid.hpp"
#include "robotteamsim/maps/scan.hpp"

namespace robotteamsim::maps {

/// A cell of an unbounded grid; cell (0, 0) has its lower left corner in the origin of the frame.
struct Cell {
  int col = 0;
  int row = 0;
};

/// A rectangle of cells, with its borders; at first an empty one.
struct CellBox {
  Cell low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
  Cell high{std::numeric_limits<int>::min(), std::numeric_limits<int>::min()};

  bool IsEmpty() const { return low.col > high.col; }
  void Include(const Cell& cell);
  void Include(const CellBox& other);
};

/// The hits in one cell: how many, and their mean, in the frame of the map.
struct HitCell {
  int count = 0;
  SurfacePoint mean;
};

/// The cells of a grid that the beams of a scan hit or cross.
struct ScanCells {
  enum Mark : std::uint8_t { kNone = 0, kCrossed = 1, kHit = 2 };

  CellBox box;                      ///< that contains all of them
  std::vector<std::uint8_t> marks;  ///< of the cells of the box, row by row: what the scan did there
  std::vector<SurfacePoint> hits;   ///< in the frame of the grid

  int Cols() const { return box.high.col - box.low.col + 1; }
};

/// Returns the cells of a scan. Args: pose: of base_link, in the frame of the grid.
/// Throws std::invalid_argument if a coordinate is above LogOddsMap::kLargest, or a beam is longer than kLongestBeam.
ScanCells CellsOfScan(const Scan& scan, const base::Pose& pose, double cell_m);

/// An occupancy grid of log odds [thrun2005, Table 9.1] that grows where it is needed, with the mean hit of each cell.
///
/// A cell is known once a beam has hit or crossed it. A scan changes each cell at most once, and a hit outweighs the
/// beams of the same scan that cross its cell. The log odds are limited, so that a door that opens, or a robot that has
/// gone, disappears.
class LogOddsMap {
 public:
  /// Throws std::invalid_argument if the edge of a cell is not from 1 mm to 10 m.
  explicit LogOddsMap(double cell_m);
  LogOddsMap(LogOddsMap&&) = default;
  LogOddsMap& operator=(LogOddsMap&&) = default;

  double cell_m() const { return cell_m_; }

  /// Adds a scan. Args: scan: for cells of the same size.  origin: the cell of the scan's grid that is (0, 0) here.
  /// Throws std::invalid_argument if the map would become wider than kWidest.
  void InsertCells(const ScanCells& scan, const Cell& origin = {});

  /// Adds a scan. Args: pose: of base_link, in the frame of the map. Throws std::invalid_argument as CellsOfScan, too.
  void Insert(const Scan& scan, const base::Pose& pose) { InsertCells(CellsOfScan(scan, pose, cell_m_)); }

  /// Add what is free in another map, and what was hit there. Args: pose: of its frame, in this one.
  /// Throw std::invalid_argument as above.
  void AddFree(const OccupancyGrid& grid, const base::Pose& pose);
  void AddHits(const std::vector<HitCell>& hits, const base::Pose& pose);

  /// The cell that contains a point; for one beyond kLargest, some cell of which nothing is known.
  Cell CellOf(const base::Point& point) const;

  /// The same. Throws std::invalid_argument if a coordinate is above kLargest.
  Cell CheckedCellOf(const base::Point& point) const;

  /// The log odds of a cell, 0: unknown. A hit adds kHit, a beam that crosses it kMiss.
  int LogOdds(const Cell& cell) const {
    const int place = PlaceOfTile(cell);
    return place < 0 || tiles_[place] == nullptr ? 0 : (*tiles_[place])[PlaceInTile(cell)];
  }

  /// Whether anything is unknown in a square of cells around one. Args: reach: between it and the border of the square.
  bool IsUnknownNear(const Cell& cell, int reach) const {
    int known = 0;
    for (int row = cell.row - reach; row <= cell.row + reach; ++row) {
      ForKnownPieces(row, cell.col - reach, cell.col + reach, [&](int, int count, const std::int8_t* cells) {
        known += count - static_cast<int>(std::count(cells, cells + count, std::int8_t{0}));
      });
    }
    return known < (2 * reach + 1) * (2 * reach + 1);
  }

  /// Calls a function with the hits of each occupied cell in a square of cells around a point within kLargest.
  /// Args: reach: the cells between the point's own and the border of the square.
  template <typename Function>
  void ForHitsNear(const base::Point& point, int reach, Function function) const {
    const Cell center = CellOf(point);
    for (int row = center.row - reach; row <= center.row + reach; ++row) {
      ForKnownPieces(row, center.col - reach, center.col + reach, [&](int first, int count, const std::int8_t* cells) {
        for (int i = 0; i < count; ++i) {
          if (cells[i] > 0) function(hits_.at(KeyOf({first + i, row})));
        }
      });
    }
  }

  /// The hits of all occupied cells, row by row.
  std::vector<HitCell> Hits() const;

  /// What is known, in a rectangle of whole tiles that contains everything known.
  /// Throws std::invalid_argument if that has more than 1e8 cells.
  OccupancyGrid Occupancy() const { return Occupancy(Everything(), 1); }

  /// What is known in a box, in squares of `factor` x `factor` cells, of which (0, 0) begins in the origin: occupied if
  /// any of these cells is, unknown if all are. Throws std::invalid_argument as above, or if the factor is below 1.
  OccupancyGrid Occupancy(const CellBox& box, int factor) const;

  /// A rectangle of whole tiles that contains everything known.
  CellBox Everything() const;

  /// How many times a cell became free, occupied or unknown that was something else before.
  std::size_t changes() const { return changes_; }

  /// A box with all cells that did so since the last call of ForgetChanged.
  const CellBox& changed() const { return changed_; }
  void ForgetChanged() { changed_ = {}; }

  /// The memory of cells and hits [bytes].
  std::size_t Bytes() const;

  static constexpr std::int8_t kHit = 17, kMiss = -8;
  static constexpr double kLargest = 1e6;  ///< coordinate [m]
  static constexpr int kWidest = 1 << 17;  ///< number of cells from the first column or row to the last one

 private:
  static constexpr int kTileBits = 6, kTileCells = 1 << kTileBits;
  using Tile = std::array<std::int8_t, std::size_t{kTileCells} * kTileCells>;

  static std::uint64_t KeyOf(const Cell& cell) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.row)) << 32 |
           static_cast<std::uint32_t>(cell.col);
  }
  static int PlaceInTile(const Cell& cell) {
    return (cell.row & (kTileCells - 1)) << kTileBits | (cell.col & (kTileCells - 1));
  }
  /// The place of a cell's tile in `tiles_`; -1: beyond it.
  int PlaceOfTile(const Cell& cell) const {
    const int col = (cell.col >> kTileBits) - first_tile_.col, row = (cell.row >> kTileBits) - first_tile_.row;
    return col >= 0 && col < tile_cols_ && row >= 0 && row < tile_rows_ ? row * tile_cols_ + col : -1;
  }

  /// Calls a function with the column, the number and the log odds of neighbouring cells of a row that share a tile,
  /// for each tile in which something is known.
  template <typename Function>
  void ForKnownPieces(int row, int first_col, int last_col, Function function) const {
    for (int col = first_col; col <= last_col;) {
      const int end = std::min(last_col, col | (kTileCells - 1)) + 1, place = PlaceOfTile({col, row});
      if (place >= 0 && tiles_[place] != nullptr) function(col, end - col, &(*tiles_[place])[PlaceInTile({col, row})]);
      col = end;
    }
  }

  void Reach(const CellBox& box);
  void Merge(const Cell& cell, const HitCell& hits);
  void Apply(const std::uint8_t* marks, int count, const Cell& first);
  void Change(const Cell& cell, int by);
  void Note(const Cell& cell, int before, int after);

  double cell_m_;
  Cell first_tile_;
  int tile_cols_ = 0, tile_rows_ = 0;
  std::vector<std::unique_ptr<Tile>> tiles_;         ///< row by row; null: nothing known
  std::unordered_map<std::uint64_t, HitCell> hits_;  ///< of the occupied cells
  std::size_t changes_ = 0;
  CellBox changed_;
};

}  // namespace robotteamsim::maps
