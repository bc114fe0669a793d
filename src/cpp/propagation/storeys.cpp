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

/// How high a ray from a storey to one above is along its way.
class Rise {
 public:
  Rise(const Storey& low, const Storey& high)
      : from_mm_(low.floor_mm + FaceSet::kHeightMm), rise_mm_(static_cast<double>(high.floor_mm - low.floor_mm)) {}

  double height_mm() const { return rise_mm_; }

  /// Returns the share of the way at which the ray is at a height; not within 0 to 1 where it never is.
  double ShareAt(std::int64_t height_mm) const { return static_cast<double>(height_mm - from_mm_) / rise_mm_; }

 private:
  std::int64_t from_mm_;
  double rise_mm_;
};

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

void FaceSet::DivideFaces() {
  std::vector<std::vector<std::array<std::int64_t, 4>>> ends(storeys_.size());
  std::vector<std::vector<std::int32_t>> weights(storeys_.size());
  for (std::size_t i = 0; i < Size(); ++i) {
    const std::size_t storey = StoreyOf({start_x_[i], start_y_[i]});
    place_on_storey_.emplace_back(storey, ends[storey].size());
    ends[storey].push_back({start_x_[i], start_y_[i], end_x_[i], end_y_[i]});
    weights[storey].push_back(full_weight_[i]);
  }
  for (std::size_t storey = 0; storey < storeys_.size(); ++storey)
    on_storey_.emplace_back(ends[storey], weights[storey]);
}

Ray FaceSet::Between(PointMm a, PointMm b, std::int64_t enough) const {
  const std::size_t of_a = StoreyOf(a), of_b = StoreyOf(b);
  if (of_a == of_b) {
    const auto dx = static_cast<double>(b.x - a.x), dy = static_cast<double>(b.y - a.y);
    return {dx * dx + dy * dy, storeys_.size() > 1 ? on_storey_[of_a].WeightBetween(a, b) : WeightBetween(a, b), 0};
  }
  if (storeys_[of_a].floor_mm > storeys_[of_b].floor_mm) return Between(b, a, enough);
  Ray ray = BesideEnds(of_a, a, of_b, b);
  if (ray.weight < enough) ray.weight += on_storey_[of_a].WeightBetween(a, Leaving(of_a, a, of_b, b));
  if (ray.weight < enough) ray.weight += on_storey_[of_b].WeightBetween(Entering(of_a, a, of_b, b), b);
  return ray;
}

PointMm FaceSet::Leaving(std::size_t low, PointMm a, std::size_t high, PointMm b) const {
  const double share = Rise(storeys_[low], storeys_[high]).ShareAt(storeys_[low].ceiling_mm);
  return Along(a, b - storeys_[high].origin + storeys_[low].origin, std::clamp(share, 0.0, 1.0));
}

PointMm FaceSet::Entering(std::size_t low, PointMm a, std::size_t high, PointMm b) const {
  const double share = Rise(storeys_[low], storeys_[high]).ShareAt(storeys_[high].floor_mm);
  return Along(a - storeys_[low].origin + storeys_[high].origin, b, std::clamp(share, 0.0, 1.0));
}

Ray FaceSet::BesideEnds(std::size_t low, PointMm a, std::size_t high, PointMm b) const {
  const Rise rise(storeys_[low], storeys_[high]);
  const PointMm from = a - storeys_[low].origin, to = b - storeys_[high].origin;
  const auto dx = static_cast<double>(to.x - from.x), dy = static_cast<double>(to.y - from.y);
  Ray ray{dx * dx + dy * dy + rise.height_mm() * rise.height_mm(), 0, 0};
  for (std::size_t i = 0; i < storeys_.size(); ++i) {
    const Storey& storey = storeys_[i];
    const PointMm start = from + storey.origin, end = to + storey.origin;
    const double at_floor = rise.ShareAt(storey.floor_mm), at_ceiling = rise.ShareAt(storey.ceiling_mm);
    if (at_floor > 0.0 && at_floor <= 1.0) {
      const PointMm through = Along(start, end, at_floor);
      const auto is_around = [&](const std::vector<PointMm>& opening) { return IsInside(opening, through); };
      if (IsIn(storey, through) && std::none_of(storey.openings.begin(), storey.openings.end(), is_around)) {
        ray.floors += storey.floor_weight == Storey::kCounted ? 1 : 0;
        ray.weight += std::max(storey.floor_weight, 0);
      }
    }
    if (i == low || i == high || at_ceiling <= 0.0 || at_floor >= 1.0) continue;
    ray.weight += on_storey_[i].WeightBetween(Along(start, end, std::max(at_floor, 0.0)),
                                              Along(start, end, std::min(at_ceiling, 1.0)));
  }
  return ray;
}

}  // namespace robotteamsim::propagation
