#include "robotteamsim/hazards/fire.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

constexpr double kMostGap = 100.0;  // cells

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

// Returns the time in which a fire in one cell reaches its peak [s].
double TimeToPeak(const Fuel& fuel) { return std::sqrt(fuel.peak_kw / fuel.growth_kw_s2); }

void CheckFuel(const Fuel& fuel) {
  base::CheckPositive(fuel.load_kj, "load_kj");
  base::CheckPositive(fuel.peak_kw, "peak_kw");
  base::CheckPositive(fuel.growth_kw_s2, "growth_kw_s2");
}

// Returns the regions of the cells, with a border; -1 without fuel: fuels of growth are one region where no wall, door
// or bare ground is between neighbours; a fuel with a curve of its own is one region.
std::vector<int> RegionsOf(const Links& still, const std::vector<Fuel>& fuels, const std::vector<int>& fuel_of,
                           int* count) {
  std::vector<int> regions(fuel_of.size(), -1), of_fuel(fuels.size(), -1), found;
  const std::array<int, 4> shifts = {1, still.stride(), -1, -still.stride()};
  const auto grows = [&](int cell) { return fuel_of[cell] >= 0 && fuels[fuel_of[cell]].curve.empty(); };
  *count = 0;
  for (int first = 0; first < static_cast<int>(fuel_of.size()); ++first) {
    if (fuel_of[first] < 0 || regions[first] >= 0) continue;
    if (!grows(first)) {
      int& region = of_fuel[fuel_of[first]];
      regions[first] = region = region < 0 ? (*count)++ : region;
      continue;
    }
    regions[first] = (*count)++;
    found.push_back(first);
    while (!found.empty()) {
      const int cell = found.back();
      found.pop_back();
      for (int direction = 0; direction < 4; ++direction) {
        const int next = cell + shifts[direction];
        if (!still.IsOpen(cell, direction) || !grows(next) || regions[next] >= 0) continue;
        regions[next] = regions[first];
        found.push_back(next);
      }
    }
  }
  return regions;
}

// Returns links that no door lets fire through.
Links WithDoorsClosed(Links links) {
  for (int door = 0; door < links.doors(); ++door) links.SetDoor(door, 1.0, false);
  return links;
}

}  // namespace

Fire::Fire(const Links& links, std::vector<Fuel> fuels, const std::vector<int>& fuel_of_cell, double gap)
    : fuels_(std::move(fuels)),
      still_(WithDoorsClosed(links)),
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
    curves_.emplace_back(fuel.curve);
    crossing_s_.push_back(root * TimeToPeak(fuel));
  }
  for (int cell = 0; cell < static_cast<int>(size); ++cell) {
    const int kind = fuel_of_cell[cell];
    if (kind < -1 || kind >= static_cast<int>(fuels_.size())) throw std::invalid_argument("there is no such fuel");
    fuel_of_[links.Padded(cell)] = kind;
  }
  int num_regions = 0;
  region_of_ = RegionsOf(still_, fuels_, fuel_of_, &num_regions);
  front_of_region_.assign(num_regions, -1);
}

bool Fire::Ignite(int padded) {
  if (fuel_of_.at(padded) < 0 || states_[padded] != Burning::kNot) return false;
  // A fuel with a curve of its own has one fire, which the cell joins.
  const bool begins = curves_[fuel_of_[padded]].empty() || front_of_region_[region_of_[padded]] < 0;
  if (begins) {
    Begin(padded, time_s_);
  } else {
    Arrive(padded, time_s_);
  }
  return begins;
}

void Fire::Advance(const Links& links, double seconds) {
  base::CheckPositive(seconds, "seconds");
  releases_.clear();
  const double end_s = time_s_ + seconds;
  while (true) {
    const auto [front_s, front] = NextFront();
    double event_s = kNever;
    if (!events_.empty()) event_s = events_.top().at_s;
    if (std::min(front_s, event_s) > end_s) break;
    time_s_ = std::min(front_s, event_s);
    if (event_s <= front_s) {
      Handle(links);
    } else {
      const Front::Next next = *Peek(front);
      Take(front, next.padded, next.at, false);
    }
  }
  time_s_ = end_s;
  GiveOff();
}

void Fire::Handle(const Links& links) {
  const Event event = events_.top();
  events_.pop();
  if (event.at_centre) {
    for (const Step& step : steps_) MoveOn(links, event.padded, event.at_s, step);
  } else if (states_[event.padded] == Burning::kNot && due_s_[event.padded] == event.at_s) {
    // Other events are of arrivals that an earlier one, or a door, has replaced.
    Arrive(event.padded, event.at_s);
  }
}

void Fire::GiveOff() {
  std::vector<Cell> still;
  still.reserve(burning_.size());
  for (Cell& cell : burning_) {
    const Front& front = fronts_[cell.front];
    const HeatCurve& curve = CurveOf(front);
    const double age_s = time_s_ - front.begin_s;
    const double released_kj = curve.empty()
                                   ? HeatOf(cell)
                                   : cell.released_kj + (curve.HeatUntil(age_s) - front.released_kj) / front.num_cells;
    releases_.push_back({cell.padded, released_kj - cell.released_kj});
    cell.released_kj = released_kj;
    if (curve.empty() ? released_kj < FuelOf(cell).load_kj : age_s < curve.EndTime()) {
      still.push_back(cell);
    } else {
      states_[cell.padded] = Burning::kBurntOut;
    }
  }
  burning_.swap(still);
  for (Front& front : fronts_) front.released_kj = CurveOf(front).HeatUntil(time_s_ - front.begin_s);
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
      if (to < 0 || IsInner(cell.padded, step)) continue;
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
  double sum_kw = 0.0;
  for (const Cell& cell : burning_) sum_kw += CurveOf(fronts_[cell.front]).empty() ? RateOf(cell) : 0.0;
  for (const Front& front : fronts_) sum_kw += CurveOf(front).RateAt(time_s_ - front.begin_s);
  return sum_kw;
}

std::vector<Fire::Step> Fire::StepsFor(double gap) {
  base::CheckNotNegative(gap, "gap");
  if (gap > kMostGap) throw std::invalid_argument("gap must be at most 100 cells");
  std::vector<Step> steps;
  const std::vector<Direction> common = CommonDirections();
  const auto is_common = [&](int dx, int dy) {
    return std::any_of(common.begin(), common.end(), [=](const Direction& d) { return d.dx == dx && d.dy == dy; });
  };
  const int reach = std::max(kLongestStep, static_cast<int>(gap) + 1);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const double length = std::hypot(dx, dy);
      // Between the centres is half a cell more on both sides.
      const bool crosses_gaps = length <= gap + 1.0;
      if ((dx == 0 && dy == 0) || !(crosses_gaps || is_common(dx, dy))) continue;
      steps.push_back({dx, dy, length, SingleSteps(dx, dy), crosses_gaps, is_common(dx, dy)});
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

std::pair<double, int> Fire::NextFront() {
  std::pair<double, int> found = {kNever, -1};
  for (int i = 0; i < static_cast<int>(fronts_.size()); ++i) {
    const Front::Next* const next = Peek(i);
    if (next == nullptr) continue;
    const Front& front = fronts_[i];
    // The n-th cell burns when the n-th cell of a front that nothing hinders does.
    const double due_s =
        CurveOf(front).empty()
            ? front.last_s + (free_.At(front.num_cells) - free_.At(front.num_cells - 1)) * CrossingTime(next->padded)
            : front.begin_s + CurveOf(front).TimeOf(front.num_cells * fuels_[fuel_of_[next->padded]].peak_kw);
    const double at_s = std::max(due_s, time_s_);
    if (at_s - front.begin_s < CurveOf(front).EndTime()) found = std::min(found, {at_s, i});
  }
  return found;
}

const Front::Next* Fire::Peek(int front) {
  return fronts_[front].Peek([this](int padded) { return states_[padded] == Burning::kNot; });
}

void Fire::Begin(int padded, double at_s) {
  const int front = static_cast<int>(fronts_.size());
  fronts_.emplace_back(fuel_of_[padded], at_s);
  int& of_region = front_of_region_[region_of_[padded]];
  if (of_region < 0) of_region = front;
  time_s_ = at_s;
  Take(front, padded, 0.0, true);
}

void Fire::Arrive(int padded, double at_s) {
  due_s_[padded] = kNever;
  from_[padded] = -1;
  const int front = front_of_region_[region_of_[padded]];
  if (front < 0) {
    Begin(padded, at_s);
  } else {
    fronts_[front].Offer(padded, fronts_[front].last_at);
  }
}

void Fire::Take(int index, int padded, double at, bool begins) {
  Front& front = fronts_[index];
  states_[padded] = Burning::kBurns;
  ++front.num_cells;
  front.last_s = time_s_;
  front.last_at = at;
  const Cell cell{padded, time_s_, begins, 0.0, index};
  burning_.push_back(cell);
  events_.push({CentreTime(cell), padded, true});
  const double centre = at + (begins ? 0.0 : 0.5 * CrossingTime(padded));
  for (const Step& step : steps_) {
    const int to = Target(still_, padded, step);
    if (to >= 0 && IsInner(padded, step)) front.Offer(to, centre + PassageTime(padded, to, step));
  }
}

double Fire::PassageTime(int from, int to, const Step& step) const {
  // Half of the way at the speed of each cell, to the edge of the second one.
  return 0.5 * step.length * (CrossingTime(from) + CrossingTime(to)) - 0.5 * CrossingTime(to);
}

int Fire::Target(const Links& links, int from, const Step& step) const {
  const int row = from / links.stride() + step.dy, col = from % links.stride() + step.dx;
  if (row < 1 || row > rows_ || col < 1 || col > cols_) return -1;
  const int to = row * links.stride() + col;
  return fuel_of_[to] >= 0 && states_[to] == Burning::kNot ? to : -1;
}

void Fire::MoveOn(const Links& links, int from, double at_s, const Step& step) {
  const int to = Target(links, from, step);
  if (to < 0 || IsInner(from, step)) return;
  const double due_s = std::max(at_s + PassageTime(from, to, step), time_s_);
  if (due_s >= due_s_[to] || !CanMove(links, from, step)) return;
  due_s_[to] = due_s;
  from_[to] = from;
  events_.push({due_s, to, false});
}

bool Fire::CanMove(const Links& links, int from, const Step& step) const {
  const auto burns_or_is_gap = [&](int cell) { return fuel_of_[cell] >= 0 ? step.is_common : step.crosses_gaps; };
  return IsFree(links, from, step, burns_or_is_gap);
}

bool Fire::IsInner(int from, const Step& step) const {
  const int region = region_of_[from];
  if (!step.is_common || region_of_[from + step.dy * still_.stride() + step.dx] != region) return false;
  return IsFree(still_, from, step, [&](int cell) { return region_of_[cell] == region; });
}

template <typename Allowed>
bool Fire::IsFree(const Links& links, int from, const Step& step, const Allowed& allowed) const {
  return IsFreeOneWay(links, from, step, allowed, false) || IsFreeOneWay(links, from, step, allowed, true);
}

template <typename Allowed>
bool Fire::IsFreeOneWay(const Links& links, int from, const Step& step, const Allowed& allowed, bool backwards) const {
  const std::array<int, 4> shifts = {1, links.stride(), -1, -links.stride()};
  const std::size_t count = step.single.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int direction = backwards ? step.single[count - 1 - i] : step.single[i];
    if (!links.IsOpen(from, direction)) return false;
    from += shifts[direction];
    const bool is_between = i + 1 < count;
    if (is_between && !allowed(from)) return false;
  }
  return true;
}

}  // namespace robotteamsim::hazards
