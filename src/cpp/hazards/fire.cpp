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

constexpr int kReach = 3;  // cells

// The squares of all distances within reach, ascending: at most eight cells are at each.
constexpr std::array<int, 6> kDistances2 = {1, 2, 4, 5, 8, 9};

// Found by simulation of fires over uniform fuel: the mean of their heat release rates is then growth * t^2.
constexpr double kPace = 0.25;

// A cell within reach, and the directions of the steps that lead there.
struct Offset {
  int dx = 0;
  int dy = 0;
  std::uint64_t one = 0;  ///< one burning cell at this distance
  std::vector<int> steps;
};

// The steps follow the straight line as closely as steps to the east, north, west and south can.
std::vector<int> StepsTo(int dx, int dy) {
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

const std::vector<Offset>& Offsets() {
  static const std::vector<Offset> offsets = [] {
    std::vector<Offset> found;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int distance2 = dx * dx + dy * dy;
        const auto* const place = std::find(kDistances2.begin(), kDistances2.end(), distance2);
        if (place == kDistances2.end()) continue;
        found.push_back({dx, dy, std::uint64_t{1} << (8 * (place - kDistances2.begin())), StepsTo(dx, dy)});
      }
    }
    return found;
  }();
  return offsets;
}

bool Leads(const Links& links, int from, const std::vector<int>& steps, bool backwards) {
  const std::array<int, 4> shifts = {1, links.stride(), -1, -links.stride()};
  const std::size_t count = steps.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int direction = backwards ? steps[count - 1 - i] : steps[i];
    if (!links.IsOpen(from, direction)) return false;
    from += shifts[direction];
  }
  return true;
}

// Returns the square of the distance to the nearest burning cell, from their numbers.
int Nearest2(std::uint64_t burning_near) {
  std::size_t place = 0;
  while ((burning_near & 0xff) == 0) {
    burning_near >>= 8;
    ++place;
  }
  return kDistances2[place];
}

// Returns the time in which a fire in one cell reaches its peak [s].
double TimeToPeak(const Fuel& fuel) { return std::sqrt(fuel.peak_kw / fuel.growth_kw_s2); }

// Returns the heat that a cell has released after some time [kJ].
double ReleasedBy(const Fuel& fuel, double age_s, bool grows) {
  const double growing = grows ? std::min(age_s, TimeToPeak(fuel)) : 0.0;
  return std::min(fuel.growth_kw_s2 * growing * growing * growing / 3.0 + fuel.peak_kw * (age_s - growing),
                  fuel.load_kj);
}

void CheckFuel(const Fuel& fuel) {
  base::CheckPositive(fuel.load_kj, "load_kj");
  base::CheckPositive(fuel.peak_kw, "peak_kw");
  base::CheckPositive(fuel.growth_kw_s2, "growth_kw_s2");
}

}  // namespace

Fire::Fire(const Links& links, std::vector<Fuel> fuels, const std::vector<int>& fuel_of_cell,
           const std::vector<double>& thresholds)
    : fuels_(std::move(fuels)),
      fuel_of_(links.PaddedSize(), -1),
      thresholds_(links.PaddedSize(), 0.0),
      exposures_(links.PaddedSize(), 0.0),
      burning_near_(links.PaddedSize(), 0),
      states_(links.PaddedSize(), Burning::kNot),
      first_row_(links.rows() + 1),
      first_col_(links.cols() + 1) {
  const std::size_t size = static_cast<std::size_t>(links.rows()) * links.cols();
  if (fuel_of_cell.size() != size || thresholds.size() != size) {
    throw std::invalid_argument("each cell must have a fuel and a threshold");
  }
  for (const Fuel& fuel : fuels_) CheckFuel(fuel);
  for (int cell = 0; cell < static_cast<int>(size); ++cell) {
    base::CheckNotNegative(thresholds[cell], "threshold");
    const int kind = fuel_of_cell[cell];
    if (kind < -1 || kind >= static_cast<int>(fuels_.size())) throw std::invalid_argument("there is no such fuel");
    fuel_of_[links.Padded(cell)] = kind;
    thresholds_[links.Padded(cell)] = thresholds[cell];
  }
}

bool Fire::Ignite(const Links& links, int padded) {
  if (fuel_of_.at(padded) < 0 || states_[padded] != Burning::kNot) return false;
  Begin(links, padded, true);
  return true;
}

void Fire::Begin(const Links& links, int padded, bool grows) {
  states_[padded] = Burning::kBurns;
  burning_.push_back({padded, 0.0, grows, 0.0});
  Count(links, padded, true);
}

void Fire::Advance(const Links& links, double seconds) {
  base::CheckPositive(seconds, "seconds");
  releases_.clear();
  if (burning_.empty()) return;
  std::vector<int> ignited;
  for (int row = first_row_; row <= last_row_; ++row) {
    for (int padded = row * links.stride() + first_col_; padded <= row * links.stride() + last_col_; ++padded) {
      if (burning_near_[padded] == 0 || states_[padded] != Burning::kNot || fuel_of_[padded] < 0) continue;
      const Fuel& fuel = fuels_[fuel_of_[padded]];
      const double nearest2 = Nearest2(burning_near_[padded]);
      exposures_[padded] += kPace * seconds / (nearest2 * nearest2 * TimeToPeak(fuel));
      if (exposures_[padded] >= thresholds_[padded]) ignited.push_back(padded);
    }
  }
  std::vector<Cell> still;
  still.reserve(burning_.size() + ignited.size());
  for (Cell& cell : burning_) {
    const Fuel& fuel = fuels_[fuel_of_[cell.padded]];
    cell.age_s += seconds;
    const double released_kj = ReleasedBy(fuel, cell.age_s, cell.grows);
    releases_.push_back({cell.padded, released_kj - cell.released_kj});
    cell.released_kj = released_kj;
    if (released_kj < fuel.load_kj) {
      still.push_back(cell);
    } else {
      states_[cell.padded] = Burning::kBurntOut;
      Count(links, cell.padded, false);
    }
  }
  burning_.swap(still);
  for (const int padded : ignited) Begin(links, padded, false);
}

void Fire::FollowLinks(const Links& links) {
  std::fill(burning_near_.begin(), burning_near_.end(), 0);
  for (const Cell& cell : burning_) Count(links, cell.padded, true);
}

bool Fire::BurnsBeside(const Links& links, int door) const {
  return std::any_of(links.crossings().begin(), links.crossings().end(), [&](const Crossing& crossing) {
    if (crossing.door != door) return false;
    const int here = links.Padded(crossing.cell), there = here + (crossing.is_east ? 1 : links.stride());
    return states_[here] == Burning::kBurns || states_[there] == Burning::kBurns;
  });
}

double Fire::heat_release_kw() const {
  double sum = 0.0;
  for (const Cell& cell : burning_) {
    const Fuel& fuel = fuels_[fuel_of_[cell.padded]];
    sum += cell.grows ? std::min(fuel.growth_kw_s2 * cell.age_s * cell.age_s, fuel.peak_kw) : fuel.peak_kw;
  }
  return sum;
}

void Fire::Count(const Links& links, int padded, bool burns) {
  const int stride = links.stride(), row = padded / stride, col = padded % stride;
  first_row_ = std::min(first_row_, std::max(1, row - kReach));
  last_row_ = std::max(last_row_, std::min(links.rows(), row + kReach));
  first_col_ = std::min(first_col_, std::max(1, col - kReach));
  last_col_ = std::max(last_col_, std::min(links.cols(), col + kReach));
  for (const Offset& offset : Offsets()) {
    const int to_row = row + offset.dy, to_col = col + offset.dx;
    if (to_row < 1 || to_row > links.rows() || to_col < 1 || to_col > links.cols()) continue;
    if (Leads(links, padded, offset.steps, false) || Leads(links, padded, offset.steps, true)) {
      std::uint64_t& near = burning_near_[to_row * stride + to_col];
      near = burns ? near + offset.one : near - offset.one;
    }
  }
}

}  // namespace robotteamsim::hazards
