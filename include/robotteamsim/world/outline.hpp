#pragma once

#include "robotteamsim/world/drive.hpp"
#include "robotteamsim/world/solid.hpp"

namespace robotteamsim::world {

/// Returns twice the area of a triangle [m^2]; positive if a, b, c turn left.
double Cross(const base::Point& a, const base::Point& b, const base::Point& c);

/// Transforms a polygon from a frame with this pose to the frame of the pose.
Polygon Placed(const Polygon& corners, const base::Pose& pose);

/// Returns how far a polygon reaches from the origin [m].
double ReachOf(const Polygon& corners);

/// Returns half the smallest width of a convex polygon [m].
double HalfWidth(const Polygon& corners);

/// Returns the distance between two convex polygons [m]; 0 if they overlap.
double GapBetween(const Polygon& a, const Polygon& b);

/// Returns the distance of a point from a convex polygon [m]; 0 inside it.
double GapBetween(const Polygon& polygon, const base::Point& point);

/// Throws std::invalid_argument if a polygon is not convex and counter-clockwise with 3 to 8 corners around the origin.
/// Args: what: name of the polygon for the message.
void CheckFootprint(const Polygon& corners, const char* what);

/// Throws std::invalid_argument if a corner of a solid is not finite or beyond the limit of base::Check.
void CheckSolid(const Solid& solid);

}  // namespace robotteamsim::world
