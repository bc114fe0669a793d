#include "robotteamsim/maps/log_odds_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::maps {
namespace {

constexpr int kLeast = -48, kMost = 96;
/// What a free cell and a hit cell of another map add: that cell may have been seen many times.
constexpr int kFreeThere = -16, kOccupiedThere = 51;
/// More hits in a cell do not make its mean firmer: a wall may be moved.
constexpr int kMostHits = 1000;

/// The cells of a rectangle that a scan has hit or crossed.
class ScanMarks {
 public:
  enum Mark : std::uint8_t { kNone, kCrossed, kHit };

  /// Args: memory: all 0, as it is again afterwards.
  ScanMarks(const Cell& low, const Cell& high, std::vector<std::uint8_t>* memory)
      : low_(low), cols_(high.col - low.col + 1), marks_(*memory) {
    const std::size_t size = static_cast<std::size_t>(cols_) * (high.row - low.row + 1);
    if (marks_.size() < size) marks_.resize(size);
  }
  ~ScanMarks() {
    for (const Cell& cell : marked_) marks_[PlaceOf(cell)] = kNone;
  }
  ScanMarks(const ScanMarks&) = delete;
  ScanMarks& operator=(const ScanMarks&) = delete;

  void Hit(const Cell& cell) { Put(cell, kHit); }

  /// Marks the cells along a segment but the last one. Args: from, to: in cells.
  void Cross(const base::Point& from, const base::Point& to) {
    Cell cell{static_cast<int>(std::floor(from.x)), static_cast<int>(std::floor(from.y))};
    const Cell last{static_cast<int>(std::floor(to.x)), static_cast<int>(std::floor(to.y))};
    const int d_col = to.x > from.x ? 1 : -1, d_row = to.y > from.y ? 1 : -1;
    constexpr double kNever = std::numeric_limits<double>::infinity();
    // Fractions of the segment from border to border, and up to the next one.
    const double per_col = cell.col == last.col ? kNever : std::abs(1.0 / (to.x - from.x));
    const double per_row = cell.row == last.row ? kNever : std::abs(1.0 / (to.y - from.y));
    double next_col = per_col == kNever ? kNever : (cell.col + (d_col > 0 ? 1 : 0) - from.x) / (to.x - from.x);
    double next_row = per_row == kNever ? kNever : (cell.row + (d_row > 0 ? 1 : 0) - from.y) / (to.y - from.y);
    for (int left = std::abs(last.col - cell.col) + std::abs(last.row - cell.row); left > 0; --left) {
      Put(cell, kCrossed);
      const bool to_next_col = cell.row == last.row || (cell.col != last.col && next_col < next_row);
      (to_next_col ? cell.col : cell.row) += to_next_col ? d_col : d_row;
      (to_next_col ? next_col : next_row) += to_next_col ? per_col : per_row;
    }
  }

  /// Calls a function with each marked cell and its mark, in the order in which they were marked.
  template <typename Function>
  void ForEach(Function function) const {
    for (const Cell& cell : marked_) function(cell, static_cast<Mark>(marks_[PlaceOf(cell)]));
  }

 private:
  std::size_t PlaceOf(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row - low_.row) * cols_ + (cell.col - low_.col);
  }
  void Put(const Cell& cell, Mark mark) {
    std::uint8_t& now = marks_[PlaceOf(cell)];
    if (now == kNone) marked_.push_back(cell);
    now = std::max<std::uint8_t>(now, mark);
  }

  Cell low_;
  int cols_;
  std::vector<std::uint8_t>& marks_;
  std::vector<Cell> marked_;
};

/// A rectangle along the axes.
struct Box {
  base::Point least, most;

  void Include(const base::Point& point) {
    least = {std::min(least.x, point.x), std::min(least.y, point.y)};
    most = {std::max(most.x, point.x), std::max(most.y, point.y)};
  }
};

int SignOf(int value) { return (value > 0) - (value < 0); }

}  // namespace

LogOddsMap::LogOddsMap(double cell_m) : cell_m_(cell_m) {
  if (!(cell_m >= 1e-3 && cell_m <= 10.0)) throw std::invalid_argument("the edge of a cell must be from 1 mm to 10 m");
}

Cell LogOddsMap::CellOf(const base::Point& point) const {
  return {static_cast<int>(std::floor(point.x / cell_m_)), static_cast<int>(std::floor(point.y / cell_m_))};
}

void LogOddsMap::Insert(const Scan& scan, const base::Pose& pose) {
  const base::Point laser = Moved(scan.laser, pose);
  Box box{laser, laser};
  std::vector<SurfacePoint> hits;
  std::vector<base::Point> ends;
  for (const SurfacePoint& hit : scan.hits) {
    hits.push_back(Moved(hit, pose));
    ends.push_back(hits.back().at);
  }
  for (const base::Point& end : scan.free_ends) ends.push_back(Moved(end, pose));
  for (const base::Point& end : ends) {
    const bool is_near = std::abs(end.x - laser.x) <= kLongestBeam && std::abs(end.y - laser.y) <= kLongestBeam;
    if (!is_near) throw std::invalid_argument("a beam must be finite and at most 100 m long");
    box.Include(end);
  }
  Reach(box.least, box.most);
  ScanMarks marks(CellOf(box.least), CellOf(box.most), &marks_);
  const auto in_cells = [&](const base::Point& point) { return base::Point{point.x / cell_m_, point.y / cell_m_}; };
  for (const SurfacePoint& hit : hits) marks.Hit(CellOf(hit.at));
  for (const base::Point& end : ends) marks.Cross(in_cells(laser), in_cells(end));
  marks.ForEach([&](const Cell& cell, ScanMarks::Mark mark) { Change(cell, mark == ScanMarks::kHit ? kHit : kMiss); });
  for (const SurfacePoint& hit : hits) Merge({1, hit});
}

/// Adds hits to those of their cell, if it is occupied: a hit where many beams crossed it leaves it free.
void LogOddsMap::Merge(const HitCell& hits) {
  const auto found = hits_.find(KeyOf(CellOf(hits.mean.at)));
  if (found == hits_.end()) return;
  auto& [count, mean] = found->second;
  count += hits.count;
  const double share = static_cast<double>(hits.count) / count;
  const auto mix = [share](double* value, double other) { *value += share * (other - *value); };
  mix(&mean.at.x, hits.mean.at.x);
  mix(&mean.at.y, hits.mean.at.y);
  mix(&mean.normal.x, hits.mean.normal.x);
  mix(&mean.normal.y, hits.mean.normal.y);
  count = std::min(count, kMostHits);
}

void LogOddsMap::AddFree(const OccupancyGrid& grid, const base::Pose& pose) {
  const plan::GridShape& shape = grid.shape;
  const double width = shape.cols * shape.resolution_m, height = shape.rows * shape.resolution_m;
  Box box{{kLargest, kLargest}, {-kLargest, -kLargest}};
  for (const double x : {shape.origin.x, shape.origin.x + width}) {
    for (const double y : {shape.origin.y, shape.origin.y + height}) {
      box.Include(Moved(base::Point{x, y}, pose));
    }
  }
  Reach(box.least, box.most);
  const Cell low = CellOf(box.least), high = CellOf(box.most);
  OccupancyGrid here{{{low.col * cell_m_, low.row * cell_m_}, cell_m_, high.row - low.row + 1, high.col - low.col + 1},
                     {}};
  here.cells.assign(static_cast<std::size_t>(here.shape.rows) * here.shape.cols, kUnknown);
  Fill(&here, grid, pose);
  for (int row = 0; row < here.shape.rows; ++row) {
    for (int col = 0; col < here.shape.cols; ++col) {
      if (here.At(row, col) == kFree) Change({low.col + col, low.row + row}, kFreeThere);
    }
  }
}

void LogOddsMap::AddHits(const std::vector<HitCell>& hits, const base::Pose& pose) {
  for (const auto& [count, there] : hits) {
    const SurfacePoint here = Moved(there, pose);
    Reach(here.at, here.at);
    Change(CellOf(here.at), kOccupiedThere);
    Merge({count, here});
  }
}

void LogOddsMap::Reach(const base::Point& least, const base::Point& most) {
  for (const double value : {least.x, least.y, most.x, most.y}) {
    if (!(std::abs(value) <= kLargest)) throw std::invalid_argument("a map must be within 1000 km of the origin");
  }
  const Cell low = CellOf(least), high = CellOf(most);
  Cell first{low.col >> kTileBits, low.row >> kTileBits}, last{high.col >> kTileBits, high.row >> kTileBits};
  if (!tiles_.empty()) {
    first = {std::min(first.col, first_tile_.col), std::min(first.row, first_tile_.row)};
    last = {std::max(last.col, first_tile_.col + tile_cols_ - 1), std::max(last.row, first_tile_.row + tile_rows_ - 1)};
  }
  const int cols = last.col - first.col + 1, rows = last.row - first.row + 1;
  if (cols == tile_cols_ && rows == tile_rows_) return;
  if (std::max(cols, rows) > kWidest / kTileCells) throw std::invalid_argument("the map would become too wide");
  std::vector<std::unique_ptr<Tile>> tiles(static_cast<std::size_t>(cols) * rows);
  for (int row = 0; row < tile_rows_; ++row) {
    for (int col = 0; col < tile_cols_; ++col) {
      const int new_row = row + first_tile_.row - first.row, new_col = col + first_tile_.col - first.col;
      tiles[new_row * cols + new_col] = std::move(tiles_[row * tile_cols_ + col]);
    }
  }
  tiles_ = std::move(tiles);
  first_tile_ = first;
  tile_cols_ = cols;
  tile_rows_ = rows;
}

void LogOddsMap::Change(const Cell& cell, int by) {
  std::unique_ptr<Tile>& tile = tiles_[PlaceOfTile(cell)];
  if (tile == nullptr) tile = std::make_unique<Tile>();
  std::int8_t& log_odds = (*tile)[PlaceInTile(cell)];
  const int before = SignOf(log_odds);
  log_odds = static_cast<std::int8_t>(std::clamp(log_odds + by, kLeast, kMost));
  const int after = SignOf(log_odds);
  if (after == before) return;
  ++changes_;
  if (after > 0) hits_[KeyOf(cell)];
  if (before > 0) hits_.erase(KeyOf(cell));
}

std::vector<HitCell> LogOddsMap::Hits() const {
  std::vector<std::pair<Cell, HitCell>> by_cell;
  for (const auto& [key, hits] : hits_) {
    by_cell.push_back({{static_cast<int>(static_cast<std::uint32_t>(key)), static_cast<int>(key >> 32)}, hits});
  }
  std::sort(by_cell.begin(), by_cell.end(), [](const auto& a, const auto& b) {
    return a.first.row != b.first.row ? a.first.row < b.first.row : a.first.col < b.first.col;
  });
  std::vector<HitCell> hits;
  for (const auto& [cell, of_cell] : by_cell) hits.push_back(of_cell);
  return hits;
}

OccupancyGrid LogOddsMap::Occupancy() const {
  const Cell first{first_tile_.col * kTileCells, first_tile_.row * kTileCells};
  const int rows = tile_rows_ * kTileCells, cols = tile_cols_ * kTileCells;
  if (static_cast<double>(rows) * cols > kMostCells) throw std::invalid_argument("the map has too many cells");
  OccupancyGrid grid{{{first.col * cell_m_, first.row * cell_m_}, cell_m_, rows, cols}, {}};
  grid.cells.reserve(static_cast<std::size_t>(rows) * cols);
  for (int row = first.row; row < first.row + rows; ++row) {
    for (int col = first.col; col < first.col + cols; ++col) {
      const int log_odds = LogOdds({col, row});
      grid.cells.push_back(log_odds > 0 ? kOccupied : log_odds < 0 ? kFree : kUnknown);
    }
  }
  return grid;
}

std::size_t LogOddsMap::Bytes() const {
  std::size_t tiles = 0;
  for (const std::unique_ptr<Tile>& tile : tiles_) tiles += tile != nullptr ? sizeof(Tile) : 0;
  return tiles + marks_.size() + tiles_.size() * sizeof(tiles_[0]) +
         hits_.size() * (sizeof(*hits_.begin()) + 2 * sizeof(void*));
}

}  // namespace robotteamsim::maps
