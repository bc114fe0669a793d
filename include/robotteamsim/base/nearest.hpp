#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::base {

/// Returns the point nearest to a position; the first of equally near points.
/// Throws std::invalid_argument if there are no points.
Point NearestPoint(const Point& position, const std::vector<Point>& points);

/// Returns the point nearest to a position of all but one, whose index may be -1 for none.
/// Throws std::invalid_argument if there are no others.
Point NearestOther(const Point& position, const Point* points, std::size_t count, int own);

/// Places that are reached by a point within their reach.
class Places {
 public:
  /// Args: reaches_m: one per place [m].
  /// Throws std::invalid_argument if the number of reaches differs from that of places.
  Places(std::vector<Point> places, std::vector<double> reaches_m);

  /// Returns the places that have a point within their reach: the index of each such place, ascending, and the index of
  /// the point nearest to it, the first of equally near points.
  std::vector<std::pair<int, int>> Reached(const std::vector<Point>& points) const;

 private:
  std::vector<Point> places_;
  std::vector<double> reaches_m_;
};

}  // namespace robotteamsim::base
