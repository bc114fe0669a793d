// Rays between the storeys of a building.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/propagation/face_set.hpp"

namespace robotteamsim::propagation {
namespace {

PointMm operator+(PointMm a, PointMm b) { return {a.x + b.x, a.y + b.y}; }
PointMm operator-(PointMm a, PointMm b) { return {a.x - b.x, a.y - b.y}; }

bool IsValid(const Storey& storey) {
  const auto is_near = [](std::int64_t value) { return std::abs(value) <= kMaxCoordinateMm; };
  return storey.least.x < storey.most.x && storey.least.y < storey.most.y && storey.floor_mm < storey.ceiling_mm &&
         storey.floor_weight >= Storey::kCounted && is_near(storey.least.x) && is_near(storey.least.y) &&
         is_near(storey.most.x) && is_near(storey.most.y) && is_near(storey.origin.x) && is_near(storey.origin.y) &&
         is_near(storey.floor_mm) && is_near(storey.ceiling_mm);
}

/// Returns the point at a share of the way from a to b, rounded to whole millimetres.
PointMm Along(PointMm a, PointMm b, double share) {
  return {a.x + std::llround(share * static_cast<double>(b.x - a.x)),
          a.y + std::llround(share * static_cast<double>(b.y - a.y))};
}

bool IsIn(const Storey& storey, PointMm point) {
  return storey.least.x <= point.x && point.x <= storey.most.x && storey.least.y <= point.y && point.y <= storey.most.y;
}

/// Returns the shares of the way from a to b between which it is in a storey's part of the plan; nothing if it is not.
std::optional<std::pair<double, double>> Within(const Storey& storey, PointMm a, PointMm b) {
  double from = 0.0, to = 1.0;
  const auto cut = [&](std::int64_t start, std::int64_t end, std::int64_t least, std::int64_t most) {
    const auto length = static_cast<double>(end - start);
    if (length == 0.0) return least <= start && start <= most;
    const double first = static_cast<double>(least - start) / length;
    const double last = static_cast<double>(most - start) / length;
    from = std::max(from, std::min(first, last));
    to = std::min(to, std::max(first, last));
    return from < to;
  };
  if (!cut(a.x, b.x, storey.least.x, storey.most.x) || !cut(a.y, b.y, storey.least.y, storey.most.y)) return {};
  return std::pair{from, to};
}

/// Returns whether a point is in a polygon: whether a ray from it to the right crosses an odd number of its edges.
bool IsInside(const std::vector<PointMm>& polygon, PointMm point) {
  bool is_inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const PointMm a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    if ((a.y > point.y) == (b.y > point.y)) continue;
    const auto [low, high] = a.y < b.y ? std::pair{a, b} : std::pair{b, a};
    is_inside ^= (high.x - low.x) * (point.y - low.y) > (point.x - low.x) * (high.y - low.y);
  }
  return is_inside;
}

}  // namespace

void FaceSet::CheckStoreys() const {
  for (std::size_t i = 0; i < storeys_.size(); ++i) {
    const std::string name = "storey " + std::to_string(i);
    if (!IsValid(storeys_[i])) throw std::invalid_argument(name + " must have a size and lie within 1000 km");
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

Ray FaceSet::Between(PointMm a, PointMm b, std::int64_t enough) const {
  if (storeys_.size() > 1) {
    const std::size_t of_a = StoreyOf(a), of_b = StoreyOf(b);
    if (storeys_[of_a].floor_mm < storeys_[of_b].floor_mm) return BetweenStoreys(of_a, a, of_b, b, enough);
    if (of_a != of_b) return BetweenStoreys(of_b, b, of_a, a, enough);
  }
  const auto dx = static_cast<double>(b.x - a.x), dy = static_cast<double>(b.y - a.y);
  return {dx * dx + dy * dy, WeightBetween(a, b), 0};
}

Ray FaceSet::BetweenStoreys(std::size_t low, PointMm a, std::size_t high, PointMm b, std::int64_t enough) const {
  const PointMm from = a - storeys_[low].origin, to = b - storeys_[high].origin;
  const std::int64_t from_mm = storeys_[low].floor_mm + kHeightMm, to_mm = storeys_[high].floor_mm + kHeightMm;
  const auto rise = static_cast<double>(to_mm - from_mm);
  const auto dx = static_cast<double>(to.x - from.x), dy = static_cast<double>(to.y - from.y);
  Ray ray{dx * dx + dy * dy + rise * rise, 0, 0};
  const auto share_at = [&](std::int64_t height_mm) { return static_cast<double>(height_mm - from_mm) / rise; };
  for (const Storey& storey : storeys_) {
    if (storey.floor_mm <= from_mm || storey.floor_mm > to_mm || ray.weight >= enough) continue;
    const PointMm through = Along(from, to, share_at(storey.floor_mm)) + storey.origin;
    const auto is_around = [&](const std::vector<PointMm>& opening) { return IsInside(opening, through); };
    if (!IsIn(storey, through) || std::any_of(storey.openings.begin(), storey.openings.end(), is_around)) continue;
    ray.floors += storey.floor_weight == Storey::kCounted ? 1 : 0;
    ray.weight += std::max(storey.floor_weight, 0);
  }
  for (const Storey& storey : storeys_) {
    const double first = std::max(0.0, share_at(storey.floor_mm)), last = std::min(1.0, share_at(storey.ceiling_mm));
    if (first >= last || ray.weight >= enough) continue;
    const PointMm start = from + storey.origin, end = to + storey.origin;
    const auto within = Within(storey, start, end);
    if (!within || !(std::max(first, within->first) < std::min(last, within->second))) continue;
    ray.weight += WeightBetween(Along(start, end, std::max(first, within->first)),
                                Along(start, end, std::min(last, within->second)));
  }
  return ray;
}

}  // namespace robotteamsim::propagation
