#include "robotteamsim/hazards/burning_floor.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

/// Returns the values of all cells without the border; value_of takes an index with it.
template <typename Value, typename Function>
std::vector<Value> WithoutBorder(const Links& links, const Function& value_of) {
  const int rows = links.rows(), cols = links.cols();
  std::vector<Value> values(static_cast<std::size_t>(rows) * cols);
  Value* to = values.data();
  for (int row = 1; row <= rows; ++row, to += cols) {
    const int begin = row * links.stride() + 1;
    for (int col = 0; col < cols; ++col) to[col] = value_of(begin + col);
  }
  return values;
}

}  // namespace

BurningFloor::BurningFloor(Links links, Fire fire, const AirModel& air, const Yields& yields,
                           std::vector<DoorModel> doors, std::vector<OpeningCell> openings)
    : links_(std::move(links)),
      fire_(std::move(fire)),
      air_(air, links_, std::move(openings)),
      cell_area_m2_(air.cell_m * air.cell_m),
      yields_(yields),
      doors_(std::move(doors)),
      heated_s_(doors_.size(), 0.0),
      is_burnt_through_(doors_.size(), false) {
  base::CheckNotNegative(yields.soot_g_kj, "soot");
  base::CheckNotNegative(yields.warmth, "warmth");
  if (yields.warmth > 1.0) throw std::invalid_argument("warmth must be at most 1");
  if (static_cast<int>(doors_.size()) != links_.doors()) throw std::invalid_argument("each door must have a model");
  for (std::size_t door = 0; door < doors_.size(); ++door) {
    base::Check(doors_[door].endures_s, "endures_s");
    Apply(static_cast<int>(door));
  }
}

bool BurningFloor::Ignite(int cell) {
  if (cell < 0 || cell >= links_.rows() * links_.cols()) throw std::invalid_argument("there is no such cell");
  return fire_.Ignite(links_.Padded(cell));
}

void BurningFloor::SetDoor(int door, bool closed) {
  if (doors_.at(door).closed == closed) return;
  doors_[door].closed = closed;
  const Links before = links_;
  Apply(door);
  fire_.FollowLinks(before, links_);
}

void BurningFloor::Advance(double seconds) {
  fire_.Advance(links_, seconds);
  for (const Release& release : fire_.releases()) {
    air_.Add(release.padded, yields_.soot_g_kj * release.heat_kj / cell_area_m2_,
             yields_.warmth * release.heat_kj / cell_area_m2_);
  }
  air_.Advance(links_, seconds);
  if (fire_.num_burning() == 0) return;
  for (int door = 0; door < links_.doors(); ++door) {
    const DoorModel& model = doors_[door];
    if (!model.closed || model.endures_s < 0.0 || is_burnt_through_[door] || !fire_.BurnsBeside(links_, door)) continue;
    heated_s_[door] += seconds;
    if (heated_s_[door] < model.endures_s) continue;
    is_burnt_through_[door] = true;
    const Links before = links_;
    Apply(door);
    fire_.FollowLinks(before, links_);
  }
}

std::vector<Burning> BurningFloor::States() const {
  return WithoutBorder<Burning>(links_, [this](int i) { return fire_.states()[i]; });
}

std::vector<double> BurningFloor::Soot() const {
  return WithoutBorder<double>(links_, [this](int i) { return air_.soot()[i]; });
}

std::vector<float> BurningFloor::SootDensity(double height_m) const {
  base::CheckPositive(height_m, "height_m");
  const double* const soot = air_.soot().data();
  const double share = 1.0 / height_m;
  return WithoutBorder<float>(links_, [=](int i) { return static_cast<float>(soot[i] * share); });
}

std::vector<float> BurningFloor::Temperature(float ambient_c, float flame_c) const {
  base::Check(ambient_c, "ambient_c");
  base::Check(flame_c, "flame_c");
  const float* const excess = air_.excess().data();
  std::vector<float> temperature = WithoutBorder<float>(links_, [=](int i) { return ambient_c + excess[i]; });
  for (const Release& release : fire_.releases()) {
    const int padded = release.padded, stride = links_.stride();
    if (fire_.states()[padded] != Burning::kBurns) continue;
    float& cell = temperature[(padded / stride - 1) * links_.cols() + padded % stride - 1];
    cell = std::max(cell, flame_c);
  }
  return temperature;
}

void BurningFloor::Apply(int door) {
  const bool holds = doors_[door].closed && !is_burnt_through_[door];
  links_.SetDoor(door, holds ? doors_[door].closed_share : doors_[door].open_share, !holds);
}

}  // namespace robotteamsim::hazards
