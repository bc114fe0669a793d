#include "robotteamsim/hazards/fire.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kMostGap = 100.0;  // cells

// Steps of at most so many cells along an axis, 32 in all: the shortest paths are at most 1.3 % longer than the
// straight line.
constexpr int kLongest = 3;

// The steps to neighbours follow the straight line as closely as steps to the east, north, west and south can.
std::vector<int> SingleSteps(int dx, int dy) {
  std::vector<int> steps;
  const int along_x = dx > 0 ? 0 : 2, along_y = dy > 0 ? 1 : 3;
  int x = 0, y = 0;
  while (x < std::abs(dx) || y < std::abs(dy)) {
    // Compares how far the middle of each step is along the line.
    if ((2 * x + 1) * std::abs(dy) <= (2 * y + 1) * std::abs(dx) && x < std::abs(dx)) {
      steps.push_back(along_x);
      ++x;
    } else {
      steps.push_back(along_y);
      ++y;
    }
  }
  return steps;
}

bool IsCommon(int dx, int dy) { return std::max(std::abs(dx), std::abs(dy)) <= kLongest && std::gcd(dx, dy) == 1; }

// Returns the area that a front of speed 1 encloses after a time of 1: that of the polygon with a corner at the
// distance 1 in the direction of each common step.
double FrontArea() {
  std::vector<double> directions;
  for (int dy = -kLongest; dy <= kLongest; ++dy) {
    for (int dx = -kLongest; dx <= kLongest; ++dx) {
      if (IsCommon(dx, dy)) directions.push_back(std::atan2(dy, dx));
    }
  }
  std::sort(directions.begin(), directions.end());
  double area = 0.0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    area += 0.5 * std::sin(directions[(i + 1) % directions.size()] - directions[i]);
  }
  return area;
}

// Returns the time in which a fire in one cell reaches its peak [s].
double TimeToPeak(const Fuel& fuel) { return std::sqrt(fuel.peak_kw / fuel.growth_kw_s2); }

void CheckFuel(const Fuel& fuel) {
  base::CheckPositive(fuel.load_kj, "load_kj");
  base::CheckPositive(fuel.peak_kw, "peak_kw");
  base::CheckPositive(fuel.growth_kw_s2, "growth_kw_s2");
}

}  // namespace

Fire::Fire(const Links& links, std::vector<Fuel> fuels, const std::vector<int>& fuel_of_cell, double gap)
    : fuels_(std::move(fuels)),
      steps_(StepsFor(gap)),
      rows_(links.rows()),
      cols_(links.cols()),
      fuel_of_(links.PaddedSize(), -1),
      due_s_(links.PaddedSize(), kNever),
      from_(links.PaddedSize(), -1),
      states_(links.PaddedSize(), Burning::kNot) {
  const std::size_t size = static_cast<std::size_t>(links.rows()) * links.cols();
  if (fuel_of_cell.size() != size) throw std::invalid_argument("each cell must have a fuel");
  const double root = std::sqrt(FrontArea());
  for (const Fuel& fuel : fuels_) {
    CheckFuel(fuel);
    crossing_s_.push_back(root * TimeToPeak(fuel));
  }
  for (int cell = 0; cell < static_cast<int>(size); ++cell) {
    const int kind = fuel_of_cell[cell];
    if (kind < -1 || kind >= static_cast<int>(fuels_.size())) throw std::invalid_argument("there is no such fuel");
    fuel_of_[links.Padded(cell)] = kind;
  }
}

bool Fire::Ignite(int padded) {
  if (fuel_of_.at(padded) < 0 || states_[padded] != Burning::kNot) return false;
  Begin(padded, time_s_, true);
  return true;
}

void Fire::Advance(const Links& links, double seconds) {
  base::CheckPositive(seconds, "seconds");
  releases_.clear();
  const double end_s = time_s_ + seconds;
  while (!events_.empty() && events_.top().at_s <= end_s) {
    const Event event = events_.top();
    events_.pop();
    time_s_ = event.at_s;
    if (event.at_centre) {
      for (const Step& step : steps_) MoveOn(links, event.padded, event.at_s, step);
    } else if (states_[event.padded] == Burning::kNot && due_s_[event.padded] == event.at_s) {
      // Other events are of arrivals that an earlier one, or a door, has replaced.
      Begin(event.padded, event.at_s, false);
    }
  }
  time_s_ = end_s;
  std::vector<Cell> still;
  still.reserve(burning_.size());
  for (Cell& cell : burning_) {
    const double released_kj = HeatOf(cell);
    releases_.push_back({cell.padded, released_kj - cell.released_kj});
    cell.released_kj = released_kj;
    if (released_kj < FuelOf(cell).load_kj) {
      still.push_back(cell);
    } else {
      states_[cell.padded] = Burning::kBurntOut;
    }
  }
  burning_.swap(still);
}

void Fire::FollowLinks(const Links& before, const Links& after) {
  std::vector<bool> is_lost(states_.size(), false);
  for (int padded = 0; padded < static_cast<int>(states_.size()); ++padded) {
    if (states_[padded] != Burning::kNot || from_[padded] < 0) continue;
    const int stride = after.stride(), from = from_[padded];
    const int dx = padded % stride - from % stride, dy = padded / stride - from / stride;
    const auto step =
        std::find_if(steps_.begin(), steps_.end(), [&](const Step& s) { return s.dx == dx && s.dy == dy; });
    if (CanMove(after, from, *step)) continue;
    is_lost[padded] = true;
    due_s_[padded] = kNever;
    from_[padded] = -1;
  }
  for (const Cell& cell : burning_) {
    const double at_s = CentreTime(cell);
    if (at_s > time_s_) continue;
    for (const Step& step : steps_) {
      const int to = Target(after, cell.padded, step);
      if (to < 0) continue;
      if (is_lost[to]) {
        MoveOn(after, cell.padded, at_s, step);
      } else if (!CanMove(before, cell.padded, step)) {
        MoveOn(after, cell.padded, time_s_, step);
      }
    }
  }
}

bool Fire::BurnsBeside(const Links& links, int door) const {
  return std::any_of(links.crossings().begin(), links.crossings().end(), [&](const Crossing& crossing) {
    if (crossing.door != door) return false;
    const int here = links.Padded(crossing.cell), there = here + (crossing.is_east ? 1 : links.stride());
    return states_[here] == Burning::kBurns || states_[there] == Burning::kBurns;
  });
}

double Fire::heat_release_kw() const {
  return std::accumulate(burning_.begin(), burning_.end(), 0.0,
                         [this](double sum, const Cell& cell) { return sum + RateOf(cell); });
}

std::vector<Fire::Step> Fire::StepsFor(double gap) {
  base::CheckNotNegative(gap, "gap");
  if (gap > kMostGap) throw std::invalid_argument("gap must be at most 100 cells");
  std::vector<Step> steps;
  const int reach = std::max(kLongest, static_cast<int>(gap) + 1);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const double length = std::hypot(dx, dy);
      // Between the centres is half a cell more on both sides.
      const bool crosses_gaps = length <= gap + 1.0;
      if ((dx == 0 && dy == 0) || !(crosses_gaps || IsCommon(dx, dy))) continue;
      steps.push_back({dx, dy, length, SingleSteps(dx, dy), crosses_gaps, IsCommon(dx, dy)});
    }
  }
  return steps;
}

double Fire::CentreTime(const Cell& cell) const {
  return cell.since_s + (cell.begins ? 0.0 : 0.5 * CrossingTime(cell.padded));
}

double Fire::HeatOf(const Cell& cell) const {
  const Fuel& fuel = FuelOf(cell);
  const double age_s = time_s_ - cell.since_s;
  const double rise_s = cell.begins ? TimeToPeak(fuel) : CrossingTime(cell.padded);
  const double rising_s = std::min(age_s, rise_s), share = rising_s / rise_s;
  const double rising_kj = fuel.peak_kw * rising_s * (cell.begins ? share * share / 3.0 : share / 2.0);
  return std::min(rising_kj + fuel.peak_kw * (age_s - rising_s), fuel.load_kj);
}

double Fire::RateOf(const Cell& cell) const {
  const Fuel& fuel = FuelOf(cell);
  const double age_s = time_s_ - cell.since_s;
  if (cell.begins) return std::min(fuel.growth_kw_s2 * age_s * age_s, fuel.peak_kw);
  return fuel.peak_kw * std::min(1.0, age_s / CrossingTime(cell.padded));
}

void Fire::Begin(int padded, double at_s, bool begins) {
  states_[padded] = Burning::kBurns;
  const Cell cell{padded, at_s, begins, 0.0};
  burning_.push_back(cell);
  events_.push({CentreTime(cell), padded, true});
}

int Fire::Target(const Links& links, int from, const Step& step) const {
  const int row = from / links.stride() + step.dy, col = from % links.stride() + step.dx;
  if (row < 1 || row > rows_ || col < 1 || col > cols_) return -1;
  const int to = row * links.stride() + col;
  return fuel_of_[to] >= 0 && states_[to] == Burning::kNot ? to : -1;
}

void Fire::MoveOn(const Links& links, int from, double at_s, const Step& step) {
  const int to = Target(links, from, step);
  if (to < 0) return;
  // Half of the way at the speed of each cell, to the edge of the second one.
  const double passage_s = 0.5 * step.length * (CrossingTime(from) + CrossingTime(to)) - 0.5 * CrossingTime(to);
  const double due_s = std::max(at_s + passage_s, time_s_);
  if (due_s >= due_s_[to] || !CanMove(links, from, step)) return;
  due_s_[to] = due_s;
  from_[to] = from;
  events_.push({due_s, to, false});
}

bool Fire::CanMove(const Links& links, int from, const Step& step) const {
  return IsFree(links, from, step, false) || IsFree(links, from, step, true);
}

bool Fire::IsFree(const Links& links, int from, const Step& step, bool backwards) const {
  const std::array<int, 4> shifts = {1, links.stride(), -1, -links.stride()};
  const std::size_t count = step.single.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int direction = backwards ? step.single[count - 1 - i] : step.single[i];
    if (!links.IsOpen(from, direction)) return false;
    from += shifts[direction];
    const bool is_between = i + 1 < count;
    if (is_between && !(fuel_of_[from] >= 0 ? step.is_common : step.crosses_gaps)) return false;
  }
  return true;
}

}  // namespace robotteamsim::hazards
