#include "robotteamsim/hazards/front.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::hazards {
namespace {

// Returns the length of the shortest path by steps in common directions [cells].
double PathLength(int dx, int dy) {
  // The common directions between 0 and 45 degrees. Neighbours span all whole numbers: their determinant is 1.
  constexpr std::array<Direction, 5> kOctant = {{{1, 0}, {3, 1}, {2, 1}, {3, 2}, {1, 1}}};
  const int x = std::max(std::abs(dx), std::abs(dy)), y = std::min(std::abs(dx), std::abs(dy));
  for (std::size_t i = 0; i + 1 < kOctant.size(); ++i) {
    const Direction low = kOctant[i], high = kOctant[i + 1];
    const int along_low = x * high.dy - y * high.dx, along_high = y * low.dx - x * low.dy;
    if (along_low >= 0 && along_high >= 0) {
      return along_low * std::hypot(low.dx, low.dy) + along_high * std::hypot(high.dx, high.dy);
    }
  }
  throw std::logic_error("directions do not cover the octant");
}

}  // namespace

std::vector<Direction> CommonDirections() {
  std::vector<Direction> directions;
  for (int dy = -kLongestStep; dy <= kLongestStep; ++dy) {
    for (int dx = -kLongestStep; dx <= kLongestStep; ++dx) {
      if (std::gcd(dx, dy) == 1) directions.push_back({dx, dy});
    }
  }
  std::sort(directions.begin(), directions.end(),
            [](const Direction& a, const Direction& b) { return std::atan2(a.dy, a.dx) < std::atan2(b.dy, b.dx); });
  return directions;
}

double FrontArea() {
  std::vector<double> angles;
  for (const Direction& direction : CommonDirections()) angles.push_back(std::atan2(direction.dy, direction.dx));
  double area = 0.0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    area += 0.5 * std::sin(angles[(i + 1) % angles.size()] - angles[i]);
  }
  return area;
}

double FreeArrivals::At(int index) {
  while (index >= static_cast<int>(at_.size())) Extend();
  return at_[index];
}

void FreeArrivals::Extend() {
  reach_ *= 2;
  at_.clear();
  for (int dy = -reach_; dy <= reach_; ++dy) {
    for (int dx = -reach_; dx <= reach_; ++dx) {
      const double length = PathLength(dx, dy);
      // Farther cells may be reached before others that are not in the square.
      if (length <= reach_) at_.push_back(std::max(length - 0.5, 0.0));
    }
  }
  std::sort(at_.begin(), at_.end());
}

HeatCurve::HeatCurve(std::vector<std::pair<double, double>> points) : points_(std::move(points)) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    base::CheckNotNegative(points_[i].first, "time_s");
    base::CheckNotNegative(points_[i].second, "rate_kw");
    if (i > 0 && points_[i].first <= points_[i - 1].first) throw std::invalid_argument("times must ascend");
  }
}

double HeatCurve::RateAt(double seconds) const {
  const auto is_before = [](double time_s, const auto& point) { return time_s < point.first; };
  const auto after = std::upper_bound(points_.begin(), points_.end(), seconds, is_before);
  if (after == points_.begin()) return 0.0;
  const auto before = after - 1;
  if (after == points_.end()) return before->second;
  const double share = (seconds - before->first) / (after->first - before->first);
  return before->second + share * (after->second - before->second);
}

double HeatCurve::HeatUntil(double seconds) const {
  double heat_kj = 0.0;
  for (std::size_t i = 0; i < points_.size() && points_[i].first < seconds; ++i) {
    const bool is_whole = i + 1 < points_.size() && points_[i + 1].first <= seconds;
    const auto [end_s, end_kw] = is_whole ? points_[i + 1] : std::pair(seconds, RateAt(seconds));
    heat_kj += 0.5 * (points_[i].second + end_kw) * (end_s - points_[i].first);
  }
  return heat_kj;
}

double HeatCurve::TimeOf(double rate_kw) const {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto [time_s, rate] = points_[i];
    if (rate < rate_kw) continue;
    if (i == 0) return time_s;
    const auto [before_s, before_kw] = points_[i - 1];
    return before_s + (rate_kw - before_kw) / (rate - before_kw) * (time_s - before_s);
  }
  return kNever;
}

double HeatCurve::EndTime() const {
  if (points_.empty() || points_.back().second > 0.0) return kNever;
  std::size_t i = points_.size() - 1;
  while (i > 0 && points_[i - 1].second == 0.0) --i;
  return points_[i].first;
}

void Front::Offer(int padded, double at) {
  const auto [found, is_new] = due_.try_emplace(padded, at);
  if (!is_new && at >= found->second) return;
  found->second = at;
  queue_.push({at, padded});
}

}  // namespace robotteamsim::hazards
