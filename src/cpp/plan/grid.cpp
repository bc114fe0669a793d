#include "robotteamsim/plan/grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"
#include "robotteamsim/plan/search_notes.hpp"

namespace robotteamsim::plan {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far from a blocked place a path may begin or end, at the nearest free cell [m].
constexpr double kNearby = 1.0;

/// With more portals, in both directions, paths are searched with a weaker bound.
constexpr std::size_t kManyJumps = 64;

/// The number of steps along a row or a column; the others are diagonal.
constexpr std::array<std::size_t, 4> kStraightSteps{1, 3, 4, 6};

double SquaredDistance(const base::Point& a, const base::Point& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

}  // namespace

PlanningGrid::PlanningGrid(const GridShape& shape, const std::vector<std::uint8_t>& occupied, double inflation_m,
                           const std::vector<Portal>& portals)
    : shape_(shape), blocked_(occupied) {
  CheckShape(shape, occupied.size());
  base::CheckNotNegative(inflation_m, "inflation_m");
  std::size_t step = 0;
  for (int d_row = -1; d_row <= 1; ++d_row) {
    for (int d_col = -1; d_col <= 1; ++d_col) {
      if (d_row == 0 && d_col == 0) continue;
      const double length = (d_row != 0 && d_col != 0 ? std::sqrt(2.0) : 1.0) * shape.resolution_m;
      steps_[step++] = {d_row * shape.cols + d_col, d_row, d_col, length};
    }
  }
  const std::vector<StampRow> stamp = InflationStamp(inflation_m, shape);
  const auto is_occupied = [&](int row, int col) {
    return !Inside(row, col) || occupied[static_cast<std::size_t>(row) * shape.cols + col] != 0;
  };
  for (int row = 0; row < shape.rows; ++row) {
    const std::uint8_t* in_row = &occupied[static_cast<std::size_t>(row) * shape.cols];
    for (int col = 0; col < shape.cols; ++col) {
      if (in_row[col] == 0) continue;
      // One of these four is at least as near to each free cell.
      if (is_occupied(row - 1, col) && is_occupied(row + 1, col) && is_occupied(row, col - 1) &&
          is_occupied(row, col + 1)) {
        continue;
      }
      for (const auto& [d_row, reach] : stamp) {
        if (row + d_row < 0 || row + d_row >= shape.rows) continue;
        const int first = std::max(col - reach, 0), last = std::min(col + reach, shape.cols - 1);
        std::fill_n(&blocked_[static_cast<std::size_t>(row + d_row) * shape.cols + first], last - first + 1, 1);
      }
    }
  }
  FindExits();
  for (const Portal& portal : portals) {
    base::Check(portal.a, "an end of a portal");
    base::Check(portal.b, "an end of a portal");
    base::CheckPositive(portal.length_m, "the length of a portal");
    if (portal.length_m > kLongestPortal * shape.resolution_m) {
      throw std::invalid_argument("a portal is longer than a million cells");
    }
    const int a = FreeCellOf(portal.a), b = FreeCellOf(portal.b);
    if (a < 0 || b < 0 || a == b) continue;
    portals_.push_back(portal);
    jumps_.push_back({CellAt(a), CellAt(b), portal.length_m});
    jumps_.push_back({CellAt(b), CellAt(a), portal.length_m});
  }
  std::stable_sort(jumps_.begin(), jumps_.end(),
                   [](const Jump& a, const Jump& b) { return a.from.index < b.from.index; });
  if (!jumps_.empty()) has_jump_.assign(blocked_.size(), 0);
  for (const Jump& jump : jumps_) has_jump_[jump.from.index] = 1;
}

int PlanningGrid::RowOf(double y) const {
  const double row = std::floor((y - shape_.origin.y) / shape_.resolution_m);
  return row >= 0.0 && row < shape_.rows ? static_cast<int>(row) : -1;
}

int PlanningGrid::ColOf(double x) const {
  const double col = std::floor((x - shape_.origin.x) / shape_.resolution_m);
  return col >= 0.0 && col < shape_.cols ? static_cast<int>(col) : -1;
}

int PlanningGrid::FreeCellOf(const base::Point& point) const {
  const int row = RowOf(point.y);
  const int col = ColOf(point.x);
  return row >= 0 && col >= 0 && Free(row, col) ? row * shape_.cols + col : -1;
}

PlanningGrid::Cell PlanningGrid::CellAt(int index) const {
  const int row = index / shape_.cols;
  return {index, row, index - row * shape_.cols};
}

base::Point PlanningGrid::Center(int row, int col) const {
  return {shape_.origin.x + (col + 0.5) * shape_.resolution_m, shape_.origin.y + (row + 0.5) * shape_.resolution_m};
}

base::Point PlanningGrid::Center(int cell) const { return Center(cell / shape_.cols, cell % shape_.cols); }

/// For all cells at once, by operations on bytes without branches, of which the compiler makes wide instructions.
void PlanningGrid::FindExits() {
  const std::size_t cols = shape_.cols, width = cols + 2;
  std::vector<std::uint8_t> free(width * (shape_.rows + 2), 0);  // with a border: 0 or, where a cell is free, all bits
  for (int row = 0; row < shape_.rows; ++row) {
    const std::uint8_t* blocked = &blocked_[row * cols];
    std::uint8_t* to = &free[(row + 1) * width + 1];
    for (std::size_t col = 0; col < cols; ++col) to[col] = blocked[col] == 0 ? 0xFF : 0;
  }
  exits_.resize(blocked_.size());
  for (int row = 0; row < shape_.rows; ++row) {
    const std::uint8_t *here = &free[(row + 1) * width + 1], *below = here - width, *above = here + width;
    const std::uint8_t *left = here - 1, *right = here + 1;
    std::uint8_t* exits = &exits_[row * cols];
    for (std::ptrdiff_t col = 0; col < shape_.cols; ++col) {  // the bits are in the order of the steps
      const unsigned straight = (below[col] & 2U) | (left[col] & 8U) | (right[col] & 16U) | (above[col] & 64U);
      const unsigned down = below[col] & ((below[col - 1] & left[col] & 1U) | (below[col + 1] & right[col] & 4U));
      const unsigned up = above[col] & ((above[col - 1] & left[col] & 32U) | (above[col + 1] & right[col] & 128U));
      exits[col] = static_cast<std::uint8_t>(here[col] & (straight | down | up));
    }
  }
}

bool PlanningGrid::IsFree(const base::Point& point) const { return FreeCellOf(point) >= 0; }

std::optional<base::Point> PlanningGrid::NearestFree(const base::Point& point, double max_distance_m) const {
  if (IsFree(point)) return point;
  return NearestInDisc(point, point, max_distance_m);
}

std::optional<base::Point> PlanningGrid::NearestInDisc(const base::Point& center, const base::Point& to,
                                                       double radius_m) const {
  base::Check(center, "center");
  base::Check(to, "goal");
  base::CheckNotNegative(radius_m, "radius_m");
  const double low_row = (center.y - radius_m - shape_.origin.y) / shape_.resolution_m - 1.0;
  const double low_col = (center.x - radius_m - shape_.origin.x) / shape_.resolution_m - 1.0;
  const double high_row = (center.y + radius_m - shape_.origin.y) / shape_.resolution_m + 1.0;
  const double high_col = (center.x + radius_m - shape_.origin.x) / shape_.resolution_m + 1.0;
  std::optional<base::Point> best;
  double best_squared = kInfinity;
  const int first_col = base::ClampedInt(low_col, 0, shape_.cols);
  for (int row = base::ClampedInt(low_row, 0, shape_.rows); row < std::min<double>(shape_.rows, high_row); ++row) {
    for (int col = first_col; col < std::min<double>(shape_.cols, high_col); ++col) {
      if (!Free(row, col)) continue;
      const base::Point cell = Center(row, col);
      const double squared = SquaredDistance(cell, to);
      if (squared >= best_squared || SquaredDistance(cell, center) > radius_m * radius_m) continue;
      best = cell;
      best_squared = squared;
    }
  }
  return best;
}

bool PlanningGrid::IsLineFree(const base::Point& a, const base::Point& b) const {
  if (FreeCellOf(a) < 0 || FreeCellOf(b) < 0) return false;
  int row = RowOf(a.y);
  int col = ColOf(a.x);
  const int last_row = RowOf(b.y);
  const int last_col = ColOf(b.x);
  const int d_row = b.y > a.y ? 1 : -1;
  const int d_col = b.x > a.x ? 1 : -1;
  const double x = (a.x - shape_.origin.x) / shape_.resolution_m;
  const double y = (a.y - shape_.origin.y) / shape_.resolution_m;
  const double dx = (b.x - a.x) / shape_.resolution_m;
  const double dy = (b.y - a.y) / shape_.resolution_m;
  while (row != last_row || col != last_col) {
    // Fractions of the segment at which it leaves the column and the row.
    const double t_col = col == last_col ? kInfinity : (col + (d_col > 0 ? 1 : 0) - x) / dx;
    const double t_row = row == last_row ? kInfinity : (row + (d_row > 0 ? 1 : 0) - y) / dy;
    if (t_col == t_row && (!Free(row + d_row, col) || !Free(row, col + d_col))) return false;
    // Not `<=`: with a NaN neither would be true, and the loop would never end.
    const bool leaves_col = !(t_col > t_row), leaves_row = !(t_row > t_col);
    if (leaves_col) col += d_col;
    if (leaves_row) row += d_row;
    if (!Free(row, col)) return false;
  }
  return true;
}

std::vector<float> PlanningGrid::DistanceMap(const base::Point& goal) const {
  const int start = FreeCellOf(goal);
  if (start < 0) throw std::invalid_argument("the goal of a distance map must be free");
  // Dijkstra with buckets as wide as the shortest step: no cell of a bucket can shorten the path of another in it, so
  // the order within a bucket does not matter. The longest step reaches two buckets ahead; portals may be longer, but
  // count as one step at least.
  std::vector<double> distance(blocked_.size(), kInfinity);
  const double width = shape_.resolution_m * (1.0 - 1e-9), per_width = 1.0 / width;
  double longest_m = 0.0;
  for (const Jump& jump : jumps_) longest_m = std::max(longest_m, jump.length_m);
  std::size_t num_buckets = 4;  // a power of two: the remainder of a division by it costs nothing
  while (static_cast<double>(num_buckets - 2) * width < longest_m) num_buckets *= 2;
  std::vector<std::vector<int>> buckets(num_buckets);
  std::size_t num_open = 0;
  const auto bucket_of = [&](double length) {
    return static_cast<std::size_t>(length * per_width) & (num_buckets - 1);
  };
  const auto reach = [&](int cell, double length) {
    if (length >= distance[cell]) return;
    distance[cell] = length;
    buckets[bucket_of(length)].push_back(cell);
    ++num_open;
  };
  reach(start, 0.0);
  std::vector<int> nearest;
  for (std::size_t current = 0; num_open > 0; current = (current + 1) % num_buckets) {
    nearest.swap(buckets[current]);
    for (const int cell : nearest) {
      const double length = distance[cell];
      if (bucket_of(length) != current) continue;  // a shorter path was found since
      const unsigned exits = exits_[cell];
      for (std::size_t s = 0; s < steps_.size(); ++s) {
        if ((exits >> s & 1U) != 0) reach(cell + steps_[s].offset, length + steps_[s].length_m);
      }
      ForJumpsFrom(
          cell, [&](const Jump& jump) { reach(jump.to.index, length + std::max(jump.length_m, shape_.resolution_m)); });
    }
    num_open -= nearest.size();
    nearest.clear();
  }
  return {distance.begin(), distance.end()};
}

double PlanningGrid::ValueAt(const float* distances, std::size_t size, const base::Point& point) const {
  if (size != blocked_.size()) throw std::invalid_argument("the distance map must have one value per cell");
  const int row = RowOf(point.y);
  const int col = ColOf(point.x);
  return row >= 0 && col >= 0 ? static_cast<double>(distances[row * shape_.cols + col]) : kInfinity;
}

std::optional<base::Point> PlanningGrid::Descend(const float* distances, std::size_t size, const base::Point& from,
                                                 double look_ahead_m) const {
  if (size != blocked_.size()) throw std::invalid_argument("the distance map must have one value per cell");
  base::Check(from, "start");
  base::CheckNotNegative(look_ahead_m, "look_ahead_m");
  const std::optional<base::Point> start = NearestFree(from, kNearby);
  if (!start) return std::nullopt;
  int cell = FreeCellOf(*start);
  if (!std::isfinite(distances[cell])) return std::nullopt;
  base::Point place = *start;
  for (double length = 0.0; length < look_ahead_m;) {
    int next = cell;
    double step_length = 0.0;
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      if ((exits_[cell] >> s & 1U) == 0 || !(distances[cell + steps_[s].offset] < distances[next])) continue;
      next = cell + steps_[s].offset;
      step_length = steps_[s].length_m;
    }
    if (next == cell || !IsLineFree(*start, Center(next))) break;
    cell = next;
    place = Center(cell);
    length += step_length;
  }
  return place;
}

/// Visits the portals that begin in a cell.
template <typename Visit>
void PlanningGrid::ForJumpsFrom(int cell, const Visit& visit) const {
  if (has_jump_.empty() || has_jump_[cell] == 0) return;
  const auto is_before = [](const Jump& jump, int from) { return jump.from.index < from; };
  for (auto jump = std::lower_bound(jumps_.begin(), jumps_.end(), cell, is_before);
       jump != jumps_.end() && jump->from.index == cell; ++jump) {
    visit(*jump);
  }
}

/// Returns the length of the path between two cells if nothing were blocked.
double PlanningGrid::LeastOnGrid(const Cell& from, const Cell& to) const {
  const int rows = std::abs(from.row - to.row);
  const int cols = std::abs(from.col - to.col);
  return (std::max(rows, cols) + (std::sqrt(2.0) - 1.0) * std::min(rows, cols)) * shape_.resolution_m;
}

/// Returns, for each portal in each direction, the length of the path through it to a goal if nothing were blocked.
std::vector<double> PlanningGrid::LeastFromJumps(const Cell& goal) const {
  std::vector<double> least;
  const auto through = [&](const Jump& jump, double from_end) {
    return std::max(jump.length_m, shape_.resolution_m) + from_end;
  };
  if (jumps_.size() > kManyJumps) {  // of a tall building: a weaker bound, which costs less
    for (const Jump& jump : jumps_) least.push_back(through(jump, 0.0));
    return least;
  }
  for (const Jump& jump : jumps_) least.push_back(through(jump, LeastOnGrid(jump.to, goal)));
  for (std::size_t round = 1; round < jumps_.size(); ++round) {  // a shortest path has each portal at most once
    bool has_changed = false;
    for (std::size_t i = 0; i < jumps_.size(); ++i) {
      for (std::size_t j = 0; j < jumps_.size(); ++j) {
        const double length = through(jumps_[i], LeastOnGrid(jumps_[i].to, jumps_[j].from) + least[j]);
        has_changed |= length < least[i];
        least[i] = std::min(least[i], length);
      }
    }
    if (!has_changed) break;
  }
  return least;
}

std::vector<base::Point> PlanningGrid::ShortestPath(const base::Point& from, const base::Point& to,
                                                    double max_length_m) const {
  base::CheckNotNegative(max_length_m, "max_length_m");
  const int start = FreeCellOf(from);
  const int goal = FreeCellOf(to);
  if (start < 0 || goal < 0) return {};
  const Cell at_goal = CellAt(goal);
  const std::vector<double> from_jumps = LeastFromJumps(at_goal);
  double least_from_jumps = kInfinity;
  for (const double length : from_jumps) least_from_jumps = std::min(least_from_jumps, length);
  const auto least_remaining = [&](const Cell& cell) {
    double least = LeastOnGrid(cell, at_goal);
    if (least <= least_from_jumps) return least;
    if (jumps_.size() > kManyJumps) return least_from_jumps;
    for (std::size_t i = 0; i < jumps_.size(); ++i) {
      least = std::min(least, LeastOnGrid(cell, jumps_[i].from) + from_jumps[i]);
    }
    return least;
  };
  struct Entry {
    double total;  // least length of a path through the cell
    double remaining;
    int cell;
    bool operator>(const Entry& other) const {
      if (total != other.total) return total > other.total;
      if (remaining != other.remaining) return remaining > other.remaining;
      return cell > other.cell;
    }
  };
  SearchNotes& notes = NewSearchNotes(blocked_.size());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto reach = [&](const Cell& cell, int parent, double length) {
    const int index = cell.index;
    if (notes.stamps[index] == notes.search && length >= notes.lengths_m[index]) return;
    const double remaining = least_remaining(cell);
    if (length + remaining > max_length_m) return;
    notes.stamps[index] = notes.search;
    notes.lengths_m[index] = length;
    notes.parents[index] = parent;
    open.push({length + remaining, remaining, index});
  };
  reach(CellAt(start), -1, 0.0);
  while (!open.empty()) {
    const Entry entry = open.top();
    open.pop();
    if (entry.cell == goal) break;
    const double length = notes.lengths_m[entry.cell];
    if (entry.total > length + entry.remaining) continue;  // a shorter path was found since
    const Cell at = CellAt(entry.cell);
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      if ((exits_[entry.cell] >> s & 1U) == 0) continue;
      const Step& step = steps_[s];
      const Cell next{entry.cell + step.offset, at.row + step.d_row, at.col + step.d_col};
      reach(next, entry.cell, length + step.length_m);
    }
    ForJumpsFrom(entry.cell, [&](const Jump& jump) {
      reach(jump.to, entry.cell, length + std::max(jump.length_m, shape_.resolution_m));
    });
  }
  std::vector<base::Point> path;
  if (notes.stamps[goal] != notes.search) return path;
  for (int cell = goal; cell >= 0; cell = notes.parents[cell]) path.push_back(Center(cell));
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<base::Point> PlanningGrid::Shortcut(const std::vector<base::Point>& path) const {
  if (path.size() < 3) return path;
  std::vector<base::Point> corners{path.front()};
  for (std::size_t i = 2; i < path.size(); ++i) {
    if (!IsLineFree(corners.back(), path[i])) corners.push_back(path[i - 1]);
  }
  corners.push_back(path.back());
  return corners;
}

template <typename Value>
std::optional<PlanningGrid::Valued> PlanningGrid::BestReachable(const base::Point& from, double radius_m,
                                                                const Value& value) const {
  const int start = FreeCellOf(from);
  if (start < 0) return std::nullopt;
  SearchNotes& notes = NewSearchNotes(blocked_.size());
  std::vector<Cell> reached{CellAt(start)};
  notes.stamps[start] = notes.search;
  int best = -1;
  double best_value = kInfinity;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const auto [cell, row, col] = reached[i];
    const base::Point center = Center(row, col);
    const double cell_value = value(cell, center);
    if (cell_value < best_value || (cell_value == best_value && best >= 0 && cell < best)) {
      best = cell;
      best_value = cell_value;
    }
    // Every diagonal step can be replaced by two straight steps.
    for (const std::size_t s : kStraightSteps) {
      const Step& step = steps_[s];
      const int next = cell + step.offset;
      if ((exits_[cell] >> s & 1U) == 0 || notes.stamps[next] == notes.search) continue;
      const base::Point next_center{center.x + step.d_col * shape_.resolution_m,
                                    center.y + step.d_row * shape_.resolution_m};
      if (SquaredDistance(next_center, from) > radius_m * radius_m) continue;
      notes.stamps[next] = notes.search;
      reached.push_back({next, row + step.d_row, col + step.d_col});
    }
  }
  if (best < 0) return std::nullopt;
  return Valued{Center(best), best_value};
}

std::optional<PlanningGrid::Valued> PlanningGrid::LeastReachable(const float* distances, std::size_t size,
                                                                 const base::Point& from, double radius_m) const {
  if (size != blocked_.size()) throw std::invalid_argument("the distance map must have one value per cell");
  base::CheckNotNegative(radius_m, "radius_m");
  return BestReachable(from, radius_m,
                       [&](int cell, const base::Point&) { return static_cast<double>(distances[cell]); });
}

std::optional<base::Point> PlanningGrid::NearestReachable(const base::Point& from, const base::Point& to,
                                                          double radius_m) const {
  base::Check(to, "goal");
  base::CheckNotNegative(radius_m, "radius_m");
  const auto best =
      BestReachable(from, radius_m, [&](int, const base::Point& center) { return SquaredDistance(center, to); });
  if (!best) return std::nullopt;
  return best->place;
}

base::Point PlanningGrid::ReachableTowards(const base::Point& from, const base::Point& goal) const {
  base::Check(from, "start");
  base::Check(goal, "goal");
  if (IsLineFree(from, goal)) return goal;
  const std::optional<base::Point> start = NearestFree(from, kNearby);
  if (!start) return goal;
  const double radius_m = base::Hypot(start->x - goal.x, start->y - goal.y) + shape_.resolution_m;
  return NearestReachable(*start, goal, radius_m).value_or(goal);
}

PlanningGrid::Valued PlanningGrid::FirstStretch(const base::Point& from, const base::Point& goal,
                                                double max_length_m) const {
  base::Check(from, "start");
  base::Check(goal, "goal");
  base::CheckNotNegative(max_length_m, "max_length_m");
  const Valued straight{goal, base::Hypot(from.x - goal.x, from.y - goal.y)};
  if (IsLineFree(from, goal)) return straight;
  const std::optional<base::Point> start = NearestFree(from, kNearby), end = NearestFree(goal, kNearby);
  if (!start || !end) return straight;
  const std::vector<base::Point> corners = Waypoints(*start, *end, max_length_m);
  if (corners.size() < 2) return straight;
  double length = 0.0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    length += base::Hypot(corners[i - 1].x - corners[i].x, corners[i - 1].y - corners[i].y);
  }
  return {corners[1], length};
}

base::Point PlanningGrid::AlongPath(const base::Point& from, const base::Point& goal, double max_length_m) const {
  const auto [bend, length] = FirstStretch(from, goal, max_length_m);
  const double bend_distance = base::Hypot(from.x - bend.x, from.y - bend.y);
  if ((bend.x == goal.x && bend.y == goal.y) || bend_distance == 0.0) return goal;
  const double stretch = length / bend_distance;
  return {from.x + stretch * (bend.x - from.x), from.y + stretch * (bend.y - from.y)};
}

}  // namespace robotteamsim::plan
