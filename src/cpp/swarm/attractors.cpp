#include "robotteamsim/swarm/attractors.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace robotteamsim {
namespace {

double SquaredDistanceToNearest(const std::vector<Point>& points, const Point& place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point& point : points) {
    const double dx = place.x - point.x, dy = place.y - point.y;
    nearest = std::min(nearest, dx * dx + dy * dy);
  }
  return nearest;
}

}  // namespace

int FarthestFrom(const std::vector<Point>& points, const Point& place, const std::vector<Point>& candidates) {
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

}  // namespace robotteamsim
