#include "robotteamsim/swarm/attractors.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace robotteamsim::swarm {
namespace {

double SquaredDistanceToNearest(const std::vector<base::Point>& points, const base::Point& place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const base::Point& point : points) {
    const double dx = place.x - point.x, dy = place.y - point.y;
    nearest = std::min(nearest, dx * dx + dy * dy);
  }
  return nearest;
}

}  // namespace

int FarthestFrom(const std::vector<base::Point>& points, const base::Point& place,
                 const std::vector<base::Point>& candidates) {
  int best = -1;
  double farthest = SquaredDistanceToNearest(points, place);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double distance = SquaredDistanceToNearest(points, candidates[i]);
    if (distance > farthest) {
      farthest = distance;
      best = static_cast<int>(i);
    }
  }
  return best;
}

}  // namespace robotteamsim::swarm
