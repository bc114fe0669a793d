#include "robotteamsim/base/nearest.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/hypot.hpp"

namespace robotteamsim::base {

Point NearestPoint(const Point& position, const std::vector<Point>& points) {
  if (points.empty()) throw std::invalid_argument("points must not be empty");
  Check(position, "position");
  const Point* nearest = &points.front();
  double least = std::numeric_limits<double>::infinity();
  for (const Point& point : points) {
    const double distance = Hypot(point.x - position.x, point.y - position.y);
    if (distance < least) {
      nearest = &point;
      least = distance;
    }
  }
  Check(*nearest, "points");
  return *nearest;
}

Places::Places(std::vector<Point> places, std::vector<double> reaches_m)
    : places_(std::move(places)), reaches_m_(std::move(reaches_m)) {
  if (reaches_m_.size() != places_.size()) throw std::invalid_argument("there must be one reach per place");
}

std::vector<std::pair<int, int>> Places::Reached(const std::vector<Point>& points) const {
  std::vector<std::pair<int, int>> reached;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    double best = std::nextafter(reaches_m_[k], std::numeric_limits<double>::infinity());
    int nearest = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double dx = points[i].x - places_[k].x, dy = points[i].y - places_[k].y;
      if (std::abs(dx) > reaches_m_[k] || std::abs(dy) > reaches_m_[k]) continue;
      const double distance = std::hypot(dx, dy);
      if (distance < best) {
        best = distance;
        nearest = static_cast<int>(i);
      }
    }
    if (nearest >= 0) reached.emplace_back(static_cast<int>(k), nearest);
  }
  return reached;
}

}  // namespace robotteamsim::base
