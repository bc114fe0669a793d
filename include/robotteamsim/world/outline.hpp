#pragma once

#include "robotteamsim/world/drive.hpp"
#include "robotteamsim/world/solid.hpp"

namespace robotteamsim::world {

/// Returns twice the area of a triangle, above 0 when a, b, c turn left [m^2].
double Cross(const base::Point& a, const base::Point& b, const base::Point& c);

/// Returns the corners of a polygon that is given in a frame with this pose.
Polygon Placed(const Polygon& corners, const base::Pose& pose);

/// Returns how far a polygon reaches from the origin [m].
double ReachOf(const Polygon& corners);

/// Returns half the smallest width of a convex polygon [m].
double HalfWidth(const Polygon& corners);

/// Returns how far two convex polygons are apart [m]; 0 where they overlap.
double GapBetween(const Polygon& a, const Polygon& b);

/// Returns how far a point is from a convex polygon [m]; 0 inside it.
double GapBetween(const Polygon& polygon, const base::Point& point);

/// Throws std::invalid_argument unless a polygon is convex and counter-clockwise, with 3 to 8 corners, and has the
/// origin in it. Args: what: whose outline it is, for the message.
void CheckFootprint(const Polygon& corners, const char* what);

}  // namespace robotteamsim::world
