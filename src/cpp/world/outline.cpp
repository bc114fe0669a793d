#include "robotteamsim/world/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/world/nearby_edges.hpp"

namespace robotteamsim::world {
namespace {

bool IsLeftOfAll(const Polygon& polygon, const base::Point& point) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (Cross(polygon[i], polygon[(i + 1) % polygon.size()], point) < 0.0) return false;
  }
  return true;
}

double DistanceToOutline(const Polygon& polygon, const base::Point& point) {
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    distance = std::min(distance, DistanceToSegment(point, {polygon[i], polygon[(i + 1) % polygon.size()]}));
  }
  return distance;
}

// Returns whether all of `other` is to the right of a side of `polygon`: of two convex polygons that do not overlap,
// one has such a side.
bool HasSideBetween(const Polygon& polygon, const Polygon& other) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const base::Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (std::all_of(other.begin(), other.end(), [&](const base::Point& point) { return Cross(a, b, point) < 0.0; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

double Cross(const base::Point& a, const base::Point& b, const base::Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

Polygon Placed(const Polygon& corners, const base::Pose& pose) {
  const double cos = std::cos(pose.yaw), sin = std::sin(pose.yaw);
  Polygon placed;
  placed.reserve(corners.size());
  for (const base::Point& corner : corners) {
    placed.push_back({pose.x + cos * corner.x - sin * corner.y, pose.y + sin * corner.x + cos * corner.y});
  }
  return placed;
}

double ReachOf(const Polygon& corners) {
  double reach_m = 0.0;
  for (const base::Point& corner : corners) reach_m = std::max(reach_m, std::hypot(corner.x, corner.y));
  return reach_m;
}

double HalfWidth(const Polygon& corners) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const base::Point& a = corners[i];
    const base::Point& b = corners[(i + 1) % corners.size()];
    double width = 0.0;
    for (const base::Point& corner : corners)
      width = std::max(width, Cross(a, b, corner) / std::hypot(b.x - a.x, b.y - a.y));
    smallest = std::min(smallest, width);
  }
  return 0.5 * smallest;
}

double GapBetween(const Polygon& a, const Polygon& b) {
  if (!HasSideBetween(a, b) && !HasSideBetween(b, a)) return 0.0;
  double gap = std::numeric_limits<double>::infinity();
  for (const base::Point& point : b) gap = std::min(gap, DistanceToOutline(a, point));
  for (const base::Point& point : a) gap = std::min(gap, DistanceToOutline(b, point));
  return gap;
}

double GapBetween(const Polygon& polygon, const base::Point& point) {
  return IsLeftOfAll(polygon, point) ? 0.0 : DistanceToOutline(polygon, point);
}

void CheckFootprint(const Polygon& corners, const char* what) {
  const std::size_t count = corners.size();
  bool fine = count >= 3 && count <= 8;
  for (std::size_t i = 0; i < count && fine; ++i) {
    const base::Point& a = corners[i];
    const base::Point& b = corners[(i + 1) % count];
    fine = base::IsUsable(a) && Cross(a, b, corners[(i + 2) % count]) > 0.0 && Cross(a, b, {0.0, 0.0}) > 0.0;
  }
  if (!fine) {
    throw std::invalid_argument(std::string(what) +
                                " must be convex and counter-clockwise, with 3 to 8 corners around its origin");
  }
}

void CheckSolid(const Solid& solid) {
  for (const base::Point& corner : solid.outline) base::Check(corner, "a corner");
  for (const Polygon& piece : solid.pieces) {
    for (const base::Point& corner : piece) base::Check(corner, "a corner");
  }
}

}  // namespace robotteamsim::world
