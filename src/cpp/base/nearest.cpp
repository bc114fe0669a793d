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
  return NearestOther(position, points.data(), points.size(), -1);
}

Point NearestOther(const Point& position, const Point* points, std::size_t count, int own) {
  Check(position, "position");
  const Point* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    if (static_cast<int>(i) == own) continue;
    const double distance = Hypot(points[i].x - position.x, points[i].y - position.y);
    if (distance < least || nearest == nullptr) {
      nearest = &points[i];
      least = distance;
    }
  }
  if (nearest == nullptr) throw std::invalid_argument("points must not be empty");
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
