#pragma once

#include <utility>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::base {

/// Returns the point nearest to a position; the first of equally near points.
/// Throws std::invalid_argument if there are no points.
Point NearestPoint(const Point& position, const std::vector<Point>& points);

/// Returns the places that have a point within their reach: the index of each such place, ascending, and the index of
/// the point nearest to it, the first of equally near points.
/// Args: reaches: one per place [m].
/// Throws std::invalid_argument if the number of reaches differs from that of places.
std::vector<std::pair<int, int>> ReachedPlaces(const std::vector<Point>& points, const std::vector<Point>& places,
                                               const std::vector<double>& reaches);

}  // namespace robotteamsim::base
