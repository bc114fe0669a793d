#include "robotteamsim/world/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace robotteamsim {

double Cross(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

Polygon Placed(const Polygon& corners, const Pose& pose) {
  const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
  Polygon placed;
  placed.reserve(corners.size());
  for (const Point& corner : corners) {
    placed.push_back({pose.x + cos * corner.x - sin * corner.y, pose.y + sin * corner.x + cos * corner.y});
  }
  return placed;
}

double ReachOf(const Polygon& corners) {
  double reach = 0.0;
  for (const Point& corner : corners) reach = std::max(reach, std::hypot(corner.x, corner.y));
  return reach;
}

double HalfWidth(const Polygon& corners) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point& a = corners[i];
    const Point& b = corners[(i + 1) % corners.size()];
    double width = 0.0;
    for (const Point& corner : corners) width = std::max(width, Cross(a, b, corner) / std::hypot(b.x - a.x, b.y - a.y));
    smallest = std::min(smallest, width);
  }
  return 0.5 * smallest;
}

void CheckFootprint(const Polygon& corners, const char* what) {
  const std::size_t count = corners.size();
  bool fine = count >= 3 && count <= 8;
  for (std::size_t i = 0; i < count && fine; ++i) {
    const Point& a = corners[i];
    const Point& b = corners[(i + 1) % count];
    fine = Cross(a, b, corners[(i + 2) % count]) > 0.0 && Cross(a, b, {0.0, 0.0}) > 0.0;
  }
  if (!fine) {
    throw std::invalid_argument(std::string(what) +
                                " must be convex and counter-clockwise, with 3 to 8 corners around its origin");
  }
}

}  // namespace robotteamsim
