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

constexpr std::int8_t kLeast = -48, kMost = 96;
/// What a free cell and a hit cell of another map add: that cell may have been seen many times.
constexpr int kFreeThere = -16, kOccupiedThere = 51;
/// More hits in a cell do not make its mean firmer: a wall may be moved.
constexpr int kMostHits = 1000;
/// Points farther away than so many cells count as being there, where no map reaches.
constexpr int kFarthest = 1 << 30;

/// Marks the cells along a segment but the last one. Args: from, to: in cells.
void Cross(const base::Point& from, const base::Point& to, ScanCells* onto) {
  const Cell first{static_cast<int>(std::floor(from.x)), static_cast<int>(std::floor(from.y))};
  const Cell last{static_cast<int>(std::floor(to.x)), static_cast<int>(std::floor(to.y))};
  const int d_col = to.x > from.x ? 1 : -1, d_row = to.y > from.y ? 1 : -1;
  int cols_left = std::abs(last.col - first.col), rows_left = std::abs(last.row - first.row);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  // Fractions of the segment from border to border, and up to the next one.
  const double per_col = cols_left == 0 ? kNever : std::abs(1.0 / (to.x - from.x));
  const double per_row = rows_left == 0 ? kNever : std::abs(1.0 / (to.y - from.y));
  double next_col = cols_left == 0 ? kNever : (first.col + (d_col > 0 ? 1 : 0) - from.x) / (to.x - from.x);
  double next_row = rows_left == 0 ? kNever : (first.row + (d_row > 0 ? 1 : 0) - from.y) / (to.y - from.y);
  const std::ptrdiff_t cols = onto->Cols(), to_next_row = d_row * cols;
  std::uint8_t* mark = &onto->marks[(first.row - onto->box.low.row) * cols + first.col - onto->box.low.col];
  while (cols_left + rows_left > 0) {
    *mark |= ScanCells::kCrossed;
    if (rows_left == 0 || (cols_left != 0 && next_col < next_row)) {
      --cols_left;
      next_col += per_col;
      mark += d_col;
    } else {
      --rows_left;
      next_row += per_row;
      mark += to_next_row;
    }
  }
}

/// A rectangle along the axes.
struct Box {
  base::Point least, most;

  void Include(const base::Point& point) {
    least = {std::min(least.x, point.x), std::min(least.y, point.y)};
    most = {std::max(most.x, point.x), std::max(most.y, point.y)};
  }
};

int SignOf(int value) { return (value > 0) - (value < 0); }

void CheckRange(const base::Point& point) {
  for (const double value : {point.x, point.y}) {
    if (!(std::abs(value) <= LogOddsMap::kLargest)) {
      throw std::invalid_argument("a map must be within 1000 km of the origin");
    }
  }
}

Cell CellAt(const base::Point& point, double cell_m) {
  const auto whole = [](double cells) { return base::ClampedInt(std::floor(cells), -kFarthest, kFarthest); };
  return {whole(point.x / cell_m), whole(point.y / cell_m)};
}

}  // namespace

void CellBox::Include(const Cell& cell) {
  low = {std::min(low.col, cell.col), std::min(low.row, cell.row)};
  high = {std::max(high.col, cell.col), std::max(high.row, cell.row)};
}

void CellBox::Include(const CellBox& other) {
  if (other.IsEmpty()) return;
  Include(other.low);
  Include(other.high);
}

ScanCells CellsOfScan(const Scan& scan, const base::Pose& pose, double cell_m) {
  const base::Point laser = Moved(scan.laser, pose);
  Box box{laser, laser};
  ScanCells cells;
  std::vector<base::Point> ends;
  for (const SurfacePoint& hit : scan.hits) {
    cells.hits.push_back(Moved(hit, pose));
    ends.push_back(cells.hits.back().at);
  }
  for (const base::Point& end : scan.free_ends) ends.push_back(Moved(end, pose));
  for (const base::Point& end : ends) {
    const bool is_near = std::abs(end.x - laser.x) <= kLongestBeam && std::abs(end.y - laser.y) <= kLongestBeam;
    if (!is_near) throw std::invalid_argument("a beam must be finite and at most 100 m long");
    box.Include(end);
  }
  CheckRange(box.least);
  CheckRange(box.most);
  cells.box = {CellAt(box.least, cell_m), CellAt(box.most, cell_m)};
  const auto& [low, high] = cells.box;
  cells.marks.assign(static_cast<std::size_t>(cells.Cols()) * (high.row - low.row + 1), ScanCells::kNone);
  const auto in_cells = [&](const base::Point& point) { return base::Point{point.x / cell_m, point.y / cell_m}; };
  for (const SurfacePoint& hit : cells.hits) {
    const Cell cell = CellAt(hit.at, cell_m);
    cells.marks[static_cast<std::size_t>(cell.row - low.row) * cells.Cols() + cell.col - low.col] = ScanCells::kHit;
  }
  for (const base::Point& end : ends) Cross(in_cells(laser), in_cells(end), &cells);
  return cells;
}

LogOddsMap::LogOddsMap(double cell_m) : cell_m_(cell_m) {
  if (!(cell_m >= 1e-3 && cell_m <= 10.0)) throw std::invalid_argument("the edge of a cell must be from 1 mm to 10 m");
}

Cell LogOddsMap::CellOf(const base::Point& point) const { return CellAt(point, cell_m_); }

void LogOddsMap::InsertCells(const ScanCells& scan, const Cell& origin) {
  const auto here = [&](const Cell& cell) { return Cell{cell.col - origin.col, cell.row - origin.row}; };
  const Cell low = here(scan.box.low), high = here(scan.box.high);
  Reach({low, high});
  const int cols = scan.Cols();
  for (int row = low.row; row <= high.row; ++row) {
    const std::uint8_t* marks = &scan.marks[static_cast<std::size_t>(row - low.row) * cols];
    for (int col = low.col; col <= high.col;) {
      const int count = std::min(kTileCells - (col & (kTileCells - 1)), high.col + 1 - col);
      Apply(marks, count, {col, row});
      marks += count;
      col += count;
    }
  }
  for (const SurfacePoint& hit : scan.hits) {
    // The cell that was marked; rounding must not choose its neighbour.
    Merge(here(CellOf(hit.at)), {1, {{hit.at.x - origin.col * cell_m_, hit.at.y - origin.row * cell_m_}, hit.normal}});
  }
}

/// Changes neighbouring cells of a row in one tile as a scan has marked them.
void LogOddsMap::Apply(const std::uint8_t* marks, int count, const Cell& first) {
  std::uint8_t any = 0;
  for (int i = 0; i < count; ++i) any |= marks[i];
  if (any == ScanCells::kNone) return;
  std::unique_ptr<Tile>& tile = tiles_[PlaceOfTile(first)];
  if (tile == nullptr) tile = std::make_unique<Tile>();
  std::int8_t* now = &(*tile)[PlaceInTile(first)];
  std::array<std::int8_t, kTileCells> before;
  std::copy_n(now, count, before.begin());
  // Operations on single bytes without branches, of which the compiler makes instructions for many at once.
  std::array<std::uint8_t, kTileCells> differences;  // their highest bits: whether the sign has changed
  std::uint8_t any_difference = 0;
  for (int i = 0; i < count; ++i) {
    const std::int8_t crossed = marks[i] != ScanCells::kNone ? kMiss : 0;
    const std::int8_t by = marks[i] >= ScanCells::kHit ? kHit : crossed;
    const auto sum = static_cast<std::int8_t>(now[i] + by);  // at most kMost + kHit
    const std::int8_t limited = sum < kLeast ? kLeast : sum;
    const std::int8_t after = limited > kMost ? kMost : limited;
    differences[i] = static_cast<std::uint8_t>((after ^ now[i]) | (-after ^ -now[i]));
    any_difference |= differences[i];
    now[i] = after;
  }
  if ((any_difference & 0x80) == 0) return;
  for (int i = 0; i < count; ++i) {
    if ((differences[i] & 0x80) != 0) Note({first.col + i, first.row}, SignOf(before[i]), SignOf(now[i]));
  }
}

/// Adds hits to those of a cell, if it is occupied: a hit where many beams crossed it leaves it free.
void LogOddsMap::Merge(const Cell& cell, const HitCell& hits) {
  const auto found = hits_.find(KeyOf(cell));
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
  const Cell low = CheckedCellOf(box.least), high = CheckedCellOf(box.most);
  Reach({low, high});
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
    const Cell cell = CheckedCellOf(here.at);
    Reach({cell, cell});
    Change(cell, kOccupiedThere);
    Merge(cell, {count, here});
  }
}

Cell LogOddsMap::CheckedCellOf(const base::Point& point) const {
  CheckRange(point);
  return CellOf(point);
}

/// Makes room for the cells of a box.
void LogOddsMap::Reach(const CellBox& box) {
  const auto& [low, high] = box;
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
  log_odds = static_cast<std::int8_t>(std::clamp<int>(log_odds + by, kLeast, kMost));
  Note(cell, before, SignOf(log_odds));
}

/// Notes that a cell has changed from one sign of its log odds to another one.
void LogOddsMap::Note(const Cell& cell, int before, int after) {
  if (after == before) return;
  ++changes_;
  changed_.Include(cell);
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
  hits.reserve(by_cell.size());
  for (const auto& [cell, of_cell] : by_cell) hits.push_back(of_cell);
  return hits;
}

CellBox LogOddsMap::Everything() const {
  const Cell first{first_tile_.col * kTileCells, first_tile_.row * kTileCells};
  return {first, {first.col + tile_cols_ * kTileCells - 1, first.row + tile_rows_ * kTileCells - 1}};
}

OccupancyGrid LogOddsMap::Occupancy(const CellBox& box, int factor) const {
  if (factor < 1) throw std::invalid_argument("the factor must be at least 1");
  if (box.IsEmpty()) return {{{0.0, 0.0}, cell_m_ * factor, 0, 0}, {}};
  const auto coarse = [factor](int cell) { return cell / factor - (cell % factor < 0 ? 1 : 0); };
  const Cell low{coarse(box.low.col), coarse(box.low.row)}, high{coarse(box.high.col), coarse(box.high.row)};
  const int rows = high.row - low.row + 1, cols = high.col - low.col + 1;
  if (static_cast<double>(rows) * cols > kMostCells) throw std::invalid_argument("the map has too many cells");
  const double coarse_m = cell_m_ * factor;
  OccupancyGrid grid{{{low.col * coarse_m, low.row * coarse_m}, coarse_m, rows, cols}, {}};
  grid.cells.assign(static_cast<std::size_t>(rows) * cols, kUnknown);
  // All cells of these squares, as far as there are any; a square may be wider than the map.
  const CellBox all = Everything();
  const auto begin = [factor](int square) { return static_cast<std::int64_t>(square) * factor; };
  const auto first_row = static_cast<int>(std::max<std::int64_t>(begin(low.row), all.low.row));
  const auto first_col = static_cast<int>(std::max<std::int64_t>(begin(low.col), all.low.col));
  const auto last_row = static_cast<int>(std::min<std::int64_t>(begin(high.row + 1) - 1, all.high.row));
  const auto last_col = static_cast<int>(std::min<std::int64_t>(begin(high.col + 1) - 1, all.high.col));
  for (int row = first_row; row <= last_row; ++row) {
    std::int8_t* cells = &grid.cells[static_cast<std::size_t>(coarse(row) - low.row) * cols];
    ForKnownPieces(row, first_col, last_col, [&](int first, int count, const std::int8_t* log_odds) {
      int square = coarse(first);
      for (int i = 0; i < count; ++square) {
        const auto end = static_cast<int>(std::min<std::int64_t>(count, begin(square + 1) - first));
        std::int8_t& cell = cells[square - low.col];
        std::int8_t known = cell;
        for (; i < end; ++i) {
          const std::int8_t now = log_odds[i] > 0 ? kOccupied : log_odds[i] < 0 ? kFree : kUnknown;
          known = std::max(known, now);  // unknown < free < occupied
        }
        cell = known;
      }
    });
  }
  return grid;
}

std::size_t LogOddsMap::Bytes() const {
  std::size_t tiles = 0;
  for (const std::unique_ptr<Tile>& tile : tiles_) tiles += tile != nullptr ? sizeof(Tile) : 0;
  return tiles + tiles_.size() * sizeof(tiles_[0]) + hits_.size() * (sizeof(*hits_.begin()) + 2 * sizeof(void*));
}

}  // namespace robotteamsim::maps
