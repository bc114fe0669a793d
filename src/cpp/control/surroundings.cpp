#include "robotteamsim/control/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/swarm/attractors.hpp"

namespace robotteamsim::control {
namespace {

/// A place is free if a disc of this radius can move there [m].
constexpr double kBeamWidth = 0.05;

}  // namespace

Surroundings::Surroundings(const LaserLayout& laser, int stride, double sensing_radius_m,
                           const std::vector<double>& headings_rad)
    : clearance_(laser),
      stride_(static_cast<std::size_t>(stride)),
      sensing_radius_m_(sensing_radius_m),
      directions_(headings_rad.begin(), headings_rad.end()) {
  if (stride < 1) throw std::invalid_argument("the stride must be at least 1");
  base::CheckPositive(sensing_radius_m, "sensing_radius_m");
  for (const double heading_rad : headings_rad) base::Check(heading_rad, "a heading");
}

std::optional<base::Point> Surroundings::ClearestPlace(const base::Pose& pose, const Ranges& ranges) const {
  base::Check(pose, "pose");
  std::vector<float> some;
  some.reserve(ranges.size / stride_ + 1);
  for (std::size_t beam = 0; beam < ranges.size; beam += stride_) some.push_back(ranges.data[beam]);
  const std::vector<base::Point> hits = clearance_.Hits(some, 2.0 * sensing_radius_m_);
  const double limit = sensing_radius_m_ * sensing_radius_m_;
  if (std::none_of(hits.begin(), hits.end(),
                   [&](const base::Point& hit) { return hit.x * hit.x + hit.y * hit.y < limit; })) {
    return std::nullopt;
  }
  const std::vector<double> free = clearance_.FreeDistances(some, directions_, kBeamWidth, sensing_radius_m_);
  std::vector<base::Point> candidates;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    for (const double reach : {0.5 * sensing_radius_m_, sensing_radius_m_}) {
      if (reach <= free[i]) candidates.push_back({reach * directions_[i].cos, reach * directions_[i].sin});
    }
  }
  const int best = swarm::FarthestFrom(hits, {0.0, 0.0}, candidates);
  const base::Point place = best < 0 ? base::Point{0.0, 0.0} : candidates[static_cast<std::size_t>(best)];
  const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
  return base::Point{pose.x + cos * place.x - sin * place.y, pose.y + sin * place.x + cos * place.y};
}

}  // namespace robotteamsim::control
