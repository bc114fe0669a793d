// Rays between the storeys of a building.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim::propagation {
namespace {

PointMm operator+(PointMm a, PointMm b) { return {a.x + b.x, a.y + b.y}; }
PointMm operator-(PointMm a, PointMm b) { return {a.x - b.x, a.y - b.y}; }

/// Largest coordinate of a storey [mm]: products of points that are moved from storey to storey fit 64 bits, too.
constexpr std::int64_t kMaxStoreyMm = kMaxCoordinateMm / 10;

bool IsValid(const Storey& storey) {
  const auto is_near = [](std::int64_t value) { return value >= -kMaxStoreyMm && value <= kMaxStoreyMm; };
  const auto has_place = [&](PointMm point) { return is_near(point.x) && is_near(point.y); };
  const auto lies_near = [&](const std::vector<PointMm>& opening) {
    return std::all_of(opening.begin(), opening.end(), has_place);
  };
  return storey.least.x < storey.most.x && storey.least.y < storey.most.y && storey.floor_mm < storey.ceiling_mm &&
         storey.floor_weight >= Storey::kCounted && has_place(storey.least) && has_place(storey.most) &&
         has_place(storey.origin) && is_near(storey.floor_mm) && is_near(storey.ceiling_mm) &&
         std::all_of(storey.openings.begin(), storey.openings.end(), lies_near);
}

/// Returns the nearest whole number, halves away from zero; unlike std::llround, it is no call of a function.
std::int64_t Rounded(double value) { return static_cast<std::int64_t>(value + (value < 0.0 ? -0.5 : 0.5)); }

bool IsIn(const Storey& storey, PointMm point) {
  return storey.least.x <= point.x && point.x <= storey.most.x && storey.least.y <= point.y && point.y <= storey.most.y;
}

/// Returns whether a point is in a polygon: whether a ray from it to the right crosses an odd number of its edges.
bool IsInside(const std::vector<PointMm>& polygon, PointMm point) {
  bool is_inside = false;
  for (std::size_t i = 0, before = polygon.size() - 1; i < polygon.size(); before = i++) {
    const PointMm a = polygon[before], b = polygon[i];
    if ((a.y > point.y) == (b.y > point.y)) continue;
    const auto [low, high] = a.y < b.y ? std::pair{a, b} : std::pair{b, a};
    is_inside ^= (high.x - low.x) * (point.y - low.y) > (point.x - low.x) * (high.y - low.y);
  }
  return is_inside;
}

}  // namespace

PointMm Along(PointMm a, PointMm b, double share) {
  return {a.x + Rounded(share * static_cast<double>(b.x - a.x)), a.y + Rounded(share * static_cast<double>(b.y - a.y))};
}

void FaceSet::CheckStoreys() const {
  for (std::size_t i = 0; i < storeys_.size(); ++i) {
    const std::string name = "storey " + std::to_string(i);
    if (!IsValid(storeys_[i])) throw std::invalid_argument(name + " must have a size and lie within 100 km");
    for (std::size_t j = 0; j < i; ++j) {
      if (storeys_[i].floor_mm == storeys_[j].floor_mm) {
        throw std::invalid_argument(name + " must not be as high as storey " + std::to_string(j));
      }
    }
  }
}

std::size_t FaceSet::StoreyOf(PointMm point) const {
  std::size_t nearest = 0;
  std::int64_t least = -1;
  for (std::size_t i = 0; i < storeys_.size(); ++i) {
    const Storey& storey = storeys_[i];
    const std::int64_t dx = std::max({storey.least.x - point.x, point.x - storey.most.x, std::int64_t{0}});
    const std::int64_t dy = std::max({storey.least.y - point.y, point.y - storey.most.y, std::int64_t{0}});
    if (least < 0 || dx + dy < least) {
      least = dx + dy;
      nearest = i;
    }
    if (least == 0) break;
  }
  return nearest;
}

void FaceSet::DivideFaces() {
  std::vector<std::vector<std::array<std::int64_t, 4>>> ends(storeys_.size());
  std::vector<std::vector<std::int32_t>> weights(storeys_.size());
  for (std::size_t i = 0; i < Size(); ++i) {
    const std::size_t storey = StoreyOf({start_x_[i], start_y_[i]});
    place_on_storey_.emplace_back(storey, ends[storey].size());
    ends[storey].push_back({start_x_[i], start_y_[i], end_x_[i], end_y_[i]});
    weights[storey].push_back(full_weight_[i]);
  }
  for (std::size_t i = 0; i < storeys_.size(); ++i) on_storey_.emplace_back(ends[i], weights[i]);
  for (std::size_t low = 0; low < storeys_.size(); ++low) {
    for (std::size_t high = 0; high < storeys_.size(); ++high) rises_.push_back(RiseBetween(low, high));
  }
}

FaceSet::Rise FaceSet::RiseBetween(std::size_t low, std::size_t high) const {
  const std::int64_t from_mm = storeys_[low].floor_mm + kHeightMm;
  const auto height_mm = static_cast<double>(storeys_[high].floor_mm - storeys_[low].floor_mm);
  const auto share_at = [&](std::int64_t at_mm) { return static_cast<double>(at_mm - from_mm) / height_mm; };
  Rise rise;
  rise.square_mm2 = height_mm * height_mm;
  if (height_mm <= 0.0) return rise;
  rise.leaving = std::clamp(share_at(storeys_[low].ceiling_mm), 0.0, 1.0);
  rise.entering = std::clamp(share_at(storeys_[high].floor_mm), 0.0, 1.0);
  for (std::size_t i = 0; i < storeys_.size(); ++i) {
    const double at_floor = share_at(storeys_[i].floor_mm), at_ceiling = share_at(storeys_[i].ceiling_mm);
    if (at_floor > 0.0 && at_floor <= 1.0) rise.floors.push_back({i, at_floor, at_floor});
    if (i == low || i == high || at_ceiling <= 0.0 || at_floor >= 1.0) continue;
    rise.in_between.push_back({i, std::max(at_floor, 0.0), std::min(at_ceiling, 1.0)});
  }
  return rise;
}

Ray FaceSet::Between(PointMm a, PointMm b) const {
  const std::size_t of_a = StoreyOf(a), of_b = StoreyOf(b);
  if (of_a == of_b) {
    const auto dx = static_cast<double>(b.x - a.x), dy = static_cast<double>(b.y - a.y);
    return {dx * dx + dy * dy, storeys_.size() > 1 ? on_storey_[of_a].WeightBetween(a, b) : WeightBetween(a, b), 0};
  }
  Ray ray = ThroughFloors(of_a, a, of_b, b);
  ray.weight += WallsBetween(of_a, a, of_b, b);
  return ray;
}

double FaceSet::SquareBetween(std::size_t of_a, PointMm a, std::size_t of_b, PointMm b) const {
  const PointMm from = a - storeys_[of_a].origin, to = b - storeys_[of_b].origin;
  const auto dx = static_cast<double>(to.x - from.x), dy = static_cast<double>(to.y - from.y);
  return dx * dx + dy * dy + RiseOf(of_a, of_b).square_mm2;
}

Ray FaceSet::ThroughFloors(std::size_t of_a, PointMm a, std::size_t of_b, PointMm b) const {
  if (IsAbove(of_a, of_b)) return ThroughFloors(of_b, b, of_a, a);
  const PointMm from = a - storeys_[of_a].origin, to = b - storeys_[of_b].origin;
  Ray ray{SquareBetween(of_a, a, of_b, b), 0, 0};
  for (const Passed& floor : RiseOf(of_a, of_b).floors) {
    const Storey& storey = storeys_[floor.storey];
    const PointMm through = Along(from, to, floor.from) + storey.origin;
    const auto is_around = [&](const std::vector<PointMm>& opening) { return IsInside(opening, through); };
    if (!IsIn(storey, through) || std::any_of(storey.openings.begin(), storey.openings.end(), is_around)) continue;
    ray.floors += storey.floor_weight == Storey::kCounted ? 1 : 0;
    ray.weight += std::max(storey.floor_weight, 0);
  }
  return ray;
}

std::int64_t FaceSet::WallsBetween(std::size_t of_a, PointMm a, std::size_t of_b, PointMm b) const {
  if (IsAbove(of_a, of_b)) return WallsBetween(of_b, b, of_a, a);
  const Rise& rise = RiseOf(of_a, of_b);
  std::int64_t weight = on_storey_[of_a].WeightBetween(a, Along(a, Moved(b, of_b, of_a), rise.leaving)) +
                        on_storey_[of_b].WeightBetween(b, Along(b, Moved(a, of_a, of_b), 1.0 - rise.entering));
  for (const Passed& passed : rise.in_between) {
    const FaceSet& faces = on_storey_[passed.storey];
    const PointMm from = Moved(a, of_a, passed.storey), to = Moved(b, of_b, passed.storey);
    const std::int64_t before = faces.WeightBetween(from, Along(from, to, passed.from));
    weight += std::max(faces.WeightBetween(from, Along(from, to, passed.to)) - before, std::int64_t{0});
  }
  return weight;
}

}  // namespace robotteamsim::propagation
