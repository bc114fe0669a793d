#include "robotteamsim/control/cell_paths.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"
#include "robotteamsim/control/voice_losses.hpp"
#include "robotteamsim/propagation/cells.hpp"

namespace robotteamsim::control {
namespace {

constexpr float kNoPath = std::numeric_limits<float>::infinity();
/// A link may be this much longer than the distance of two neighbouring cells.
constexpr double kLongestLink = 2.0;
/// A cell's place is at most this far from its centre, in cells.
constexpr double kPlaceOffCenter = 0.6;
/// The path to the first cell around a corner is at most this many times the distance within which cells are tried.
constexpr double kLongestDetour = 4.0;

struct CellStep {
  int row, col;
};
constexpr std::array<CellStep, 8> kSteps{{{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}, {0, 1}, {1, -1}, {1, 0}, {1, 1}}};

plan::GridShape CheckedCells(const plan::GridShape& cells) {
  base::Check(cells.origin, "origin_m");
  base::CheckPositive(cells.resolution_m, "cell_m");
  if (cells.rows < 1 || cells.cols < 1 || cells.rows > VoiceLosses::kMostCells / cells.cols) {
    throw std::invalid_argument("a grid of cells must have 1 to 65536 cells");
  }
  return cells;
}

double DistanceToSegment(const base::Point& point, const base::Point& a, const base::Point& b) {
  const double x = b.x - a.x, y = b.y - a.y;
  const double square = x * x + y * y;
  const double along = square > 0.0 ? std::clamp(((point.x - a.x) * x + (point.y - a.y) * y) / square, 0.0, 1.0) : 0.0;
  return Distance(point, {a.x + along * x, a.y + along * y});
}

}  // namespace

CellPaths::CellPaths(std::shared_ptr<const plan::PlanningGrid> fine, const plan::GridShape& cells,
                     const std::optional<KeptOut>& kept_out)
    : fine_(std::move(fine)), cells_(CheckedCells(cells)), kept_out_(kept_out) {
  if (fine_ == nullptr) throw std::invalid_argument("paths need a grid");
  if (kept_out_) {
    base::Check(kept_out_->center, "center_m");
    base::CheckNotNegative(kept_out_->radius_m, "radius_m");
  }
  FindPlaces();
  links_.resize(places_.size());
  for (std::array<float, kNeighbours>& links : links_) links.fill(kNoPath);
  for (int row = 0; row < cells_.rows; ++row) {
    for (int col = 0; col < cells_.cols; ++col) Link(row, col);
  }
  LinkPortals();
  lengths_.resize(places_.size());
}

void CellPaths::FindPlaces() {
  places_.reserve(static_cast<std::size_t>(cells_.rows) * cells_.cols);
  for (int row = 0; row < cells_.rows; ++row) {
    for (int col = 0; col < cells_.cols; ++col) {
      std::optional<base::Point> place =
          fine_->NearestFree(propagation::CellCenter(cells_, row, col), kPlaceOffCenter * cells_.resolution_m);
      if (place && !IsAllowed(*place, *place)) place.reset();
      places_.push_back(place);
    }
  }
}

/// Links a cell with its later neighbours, and them with it.
void CellPaths::Link(int row, int col) {
  const int cell = row * cells_.cols + col;
  if (!places_[cell]) return;
  for (int k = kNeighbours / 2; k < kNeighbours; ++k) {
    const int to_row = row + kSteps[k].row, to_col = col + kSteps[k].col;
    if (to_row < 0 || to_row >= cells_.rows || to_col < 0 || to_col >= cells_.cols) continue;
    const int other = to_row * cells_.cols + to_col;
    if (!places_[other] || !IsAllowed(*places_[cell], *places_[other])) continue;
    double length = Distance(*places_[cell], *places_[other]);
    if (!fine_->IsLineFree(*places_[cell], *places_[other])) {
      const double longest_m = kLongestLink * cells_.resolution_m;
      const std::vector<base::Point> corners = fine_->Waypoints(*places_[cell], *places_[other], longest_m);
      if (corners.size() < 2) continue;
      length = 0.0;
      for (std::size_t i = 1; i < corners.size(); ++i) length += Distance(corners[i - 1], corners[i]);
    }
    links_[cell][k] = links_[other][kNeighbours - 1 - k] = static_cast<float>(length);
  }
}

void CellPaths::LinkPortals() {
  for (const plan::Portal& portal : fine_->portals()) {
    if (!IsAllowed(portal.a, portal.a) || !IsAllowed(portal.b, portal.b)) continue;
    const int a = StartOf(portal.a), b = StartOf(portal.b);
    if (a == kNone || b == kNone || a == b) continue;
    const double length = Distance(portal.a, *places_[a]) + portal.length_m + Distance(portal.b, *places_[b]);
    if (length > plan::kLongestPortal * cells_.resolution_m) {
      throw std::invalid_argument("a portal is longer than a million cells");
    }
    jumps_.push_back({a, b, static_cast<float>(length)});
    jumps_.push_back({b, a, static_cast<float>(length)});
  }
  std::stable_sort(jumps_.begin(), jumps_.end(), [](const Jump& a, const Jump& b) { return a.from < b.from; });
  if (!jumps_.empty()) has_jump_.assign(places_.size(), 0);
  for (const Jump& jump : jumps_) has_jump_[jump.from] = 1;
}

/// Visits the ways through portals from a cell.
template <typename Visit>
void CellPaths::ForJumpsFrom(int cell, const Visit& visit) const {
  if (has_jump_.empty() || has_jump_[cell] == 0) return;
  const auto is_before = [](const Jump& jump, int from) { return jump.from < from; };
  for (auto jump = std::lower_bound(jumps_.begin(), jumps_.end(), cell, is_before);
       jump != jumps_.end() && jump->from == cell; ++jump) {
    visit(*jump);
  }
}

bool CellPaths::IsAllowed(const base::Point& a, const base::Point& b) const {
  return !kept_out_ || DistanceToSegment(kept_out_->center, a, b) > kept_out_->radius_m;
}

int CellPaths::CellOf(const base::Point& point) const {
  const double row = std::floor((point.y - cells_.origin.y) / cells_.resolution_m);
  const double col = std::floor((point.x - cells_.origin.x) / cells_.resolution_m);
  return base::ClampedInt(row, 0, cells_.rows - 1) * cells_.cols + base::ClampedInt(col, 0, cells_.cols - 1);
}

int CellPaths::StartOf(const base::Point& point) const {
  base::Check(point, "point_m");
  constexpr int kReach = 2;
  const double reach = kReach * cells_.resolution_m;
  // A robot that is too near to a wall is in no free cell.
  const std::optional<base::Point> from = fine_->NearestFree(point, cells_.resolution_m);
  const int cell = CellOf(point), row = cell / cells_.cols, col = cell % cells_.cols;
  struct Near {
    double distance;
    int cell;
    bool is_in_sight = false;
  };
  std::vector<Near> near;
  for (int r = std::max(row - kReach, 0); r <= std::min(row + kReach, cells_.rows - 1); ++r) {
    for (int c = std::max(col - kReach, 0); c <= std::min(col + kReach, cells_.cols - 1); ++c) {
      const int other = r * cells_.cols + c;
      if (places_[other] && IsLinked(other)) near.push_back({Distance(point, *places_[other]), other});
    }
  }
  const auto is_nearer = [](const Near& a, const Near& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.cell < b.cell;
  };
  std::sort(near.begin(), near.end(), is_nearer);
  // A place behind a wall is nearer than it seems. No place farther away than the first one in sight can come before
  // it.
  for (std::size_t i = 0; i < near.size(); ++i) {
    near[i].is_in_sight = from && IsInSight(*from, near[i].cell);
    if (!near[i].is_in_sight) {
      near[i].distance += reach;
    } else {
      near.resize(i + 1);
    }
  }
  std::sort(near.begin(), near.end(), is_nearer);
  for (const Near& place : near) {
    if (place.is_in_sight || !from || !fine_->ShortestPath(*from, *places_[place.cell], kLongestDetour * reach).empty())
      return place.cell;
  }
  return kNone;
}

/// Beside a place, the line to it may cross a corner of a blocked cell, but no wall.
bool CellPaths::IsInSight(const base::Point& from, int cell) const {
  return Distance(from, *places_[cell]) < fine_->shape().resolution_m || fine_->IsLineFree(from, *places_[cell]);
}

bool CellPaths::IsLinked(int cell) const {
  const auto& links = links_[cell];
  return links_.size() == 1 || std::any_of(links.begin(), links.end(), [](float length) { return length < kNoPath; });
}

void CellPaths::CheckCell(int cell) const {
  if (cell < 0 || static_cast<std::size_t>(cell) >= places_.size()) {
    throw std::invalid_argument("there is no cell " + std::to_string(cell));
  }
}

const std::optional<base::Point>& CellPaths::PlaceOf(int cell) const {
  CheckCell(cell);
  return places_[cell];
}

float CellPaths::LengthBetween(int from, int to) const {
  CheckCell(to);
  return LengthsFrom(from)[to];
}

const std::vector<float>& CellPaths::LengthsFrom(int cell) const {
  CheckCell(cell);
  std::vector<float>& lengths = lengths_[cell];
  if (!lengths.empty()) return lengths;
  lengths.assign(places_.size(), kNoPath);
  if (!places_[cell]) return lengths;
  // As in PlanningGrid::DistanceMap, but a link may be shorter than a bucket is wide: a cell whose path becomes shorter
  // is in its bucket again. A link is shorter than four cells.
  struct Reached {
    float length;
    int cell;
  };
  const float per_m = 2.0F / static_cast<float>(cells_.resolution_m);
  float longest = 0.0F;
  for (const Jump& jump : jumps_) longest = std::max(longest, jump.length);
  std::vector<std::vector<Reached>> buckets(std::max<std::size_t>(16, static_cast<std::size_t>(longest * per_m) + 2));
  std::array<int, kNeighbours> offsets{};
  for (int k = 0; k < kNeighbours; ++k) offsets[k] = kSteps[k].row * cells_.cols + kSteps[k].col;
  std::size_t num_open = 0;
  const auto reach = [&](int other, float length) {
    if (length >= lengths[other]) return;
    lengths[other] = length;
    buckets[static_cast<std::size_t>(length * per_m) % buckets.size()].push_back({length, other});
    ++num_open;
  };
  reach(cell, 0.0F);
  for (std::size_t current = 0; num_open > 0; current = (current + 1) % buckets.size()) {
    std::vector<Reached>& bucket = buckets[current];
    for (std::size_t i = 0; i < bucket.size(); ++i) {
      const Reached at = bucket[i];
      if (at.length > lengths[at.cell]) continue;  // a shorter path was found since
      for (int k = 0; k < kNeighbours; ++k) {
        const float link = links_[at.cell][k];
        if (link < kNoPath) reach(at.cell + offsets[k], at.length + link);
      }
      ForJumpsFrom(at.cell, [&](const Jump& jump) { reach(jump.to, at.length + jump.length); });
    }
    num_open -= bucket.size();
    bucket.clear();
  }
  return lengths;
}

std::optional<base::Point> CellPaths::Ahead(const base::Point& position, int goal, double longest_m) const {
  base::CheckNotNegative(longest_m, "longest_m");
  const std::vector<float>& lengths = LengthsFrom(goal);
  int at = StartOf(position);
  if (at == kNone || !(lengths[at] < kNoPath)) return std::nullopt;
  const float least = lengths[at] - static_cast<float>(longest_m);
  base::Point ahead = *places_[at];
  // A robot that is too near to a wall is in no free cell.
  const base::Point from = fine_->NearestFree(position, cells_.resolution_m).value_or(position);
  bool is_first = IsInSight(from, at);
  while (at != goal && lengths[at] > least) {
    int best = at;
    float total = kNoPath;
    for (int k = 0; k < kNeighbours; ++k) {
      if (!(links_[at][k] < kNoPath)) continue;
      const int other = at + kSteps[k].row * cells_.cols + kSteps[k].col;
      if (links_[at][k] + lengths[other] < total && lengths[other] < lengths[at]) {
        total = links_[at][k] + lengths[other];
        best = other;
      }
    }
    ForJumpsFrom(at, [&](const Jump& jump) {
      if (!(jump.length + lengths[jump.to] < total) || !(lengths[jump.to] < lengths[at])) return;
      total = jump.length + lengths[jump.to];
      best = jump.to;
    });
    if (best == at) break;
    at = best;
    if (is_first) ahead = *places_[at];  // around a corner, if it is not in sight
    is_first = false;
    if (!fine_->IsLineFree(from, *places_[at]) || !IsAllowed(from, *places_[at])) break;
    ahead = *places_[at];
  }
  return ahead;
}

std::optional<CellWay> CellPaths::WayWithin(const base::Point& position, const std::vector<std::uint8_t>& goals,
                                            const std::vector<std::uint8_t>& allowed, double longest_m) const {
  base::CheckNotNegative(longest_m, "longest_m");
  if (goals.size() != places_.size() || allowed.size() != places_.size()) {
    throw std::invalid_argument("goals and allowed must have one value per cell");
  }
  const int start = StartOf(position);
  if (start == kNone) return std::nullopt;
  CellWay way{ShortestWithin(start, goals, allowed), {}};
  if (way.cells.empty()) return std::nullopt;
  // A robot that is too near to a wall is in no free cell.
  const base::Point from = fine_->NearestFree(position, cells_.resolution_m).value_or(position);
  const bool is_at_start = IsInSight(from, start);
  way.ahead = *places_[is_at_start && way.cells.size() > 1 ? way.cells[1] : start];
  double length = 0.0;
  for (std::size_t i = 1; is_at_start && i < way.cells.size(); ++i) {
    const base::Point& place = *places_[way.cells[i]];
    length += Distance(*places_[way.cells[i - 1]], place);
    if (i > 1 && (length > longest_m || !IsLineWithin(from, place, allowed))) break;
    way.ahead = place;
  }
  return way;
}

/// Returns the cells of the shortest path to the nearest goal (Dijkstra); none without one.
std::vector<int> CellPaths::ShortestWithin(int from, const std::vector<std::uint8_t>& goals,
                                           const std::vector<std::uint8_t>& allowed) const {
  std::vector<float> lengths(places_.size(), kNoPath);
  std::vector<int> before(places_.size(), kNone);
  using Reached = std::pair<float, int>;  // of equal lengths, the lower cell first
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  lengths[from] = 0.0F;
  open.emplace(0.0F, from);
  while (!open.empty()) {
    const auto [length, at] = open.top();
    open.pop();
    if (length > lengths[at]) continue;  // a shorter path was found since
    if (goals[at] != 0) {
      std::vector<int> cells;
      for (int cell = at; cell != kNone; cell = before[cell]) cells.push_back(cell);
      std::reverse(cells.begin(), cells.end());
      return cells;
    }
    const auto reach = [&, at = at](int other, float longer) {
      if (allowed[other] == 0 || longer >= lengths[other]) return;
      lengths[other] = longer;
      before[other] = at;
      open.emplace(longer, other);
    };
    for (int k = 0; k < kNeighbours; ++k) {
      if (!(links_[at][k] < kNoPath)) continue;
      reach(at + kSteps[k].row * cells_.cols + kSteps[k].col, length + links_[at][k]);
    }
    ForJumpsFrom(at, [&, length = length](const Jump& jump) { reach(jump.to, length + jump.length); });
  }
  return {};
}

/// Whether a straight line is free, and all cells below it that have a place are allowed.
bool CellPaths::IsLineWithin(const base::Point& from, const base::Point& to,
                             const std::vector<std::uint8_t>& allowed) const {
  if (!fine_->IsLineFree(from, to) || !IsAllowed(from, to)) return false;
  const int steps = static_cast<int>(Distance(from, to) / (0.5 * cells_.resolution_m)) + 1;
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const int cell = CellOf({from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)});
    if (places_[cell] && allowed[cell] == 0) return false;
  }
  return true;
}

}  // namespace robotteamsim::control
