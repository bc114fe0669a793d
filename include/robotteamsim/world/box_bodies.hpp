#pragma once

#include "robotteamsim/world/solid.hpp"

class b2Body;
struct b2Vec2;

namespace robotteamsim::world {

// Bodies of Box2D as the parts of a world make them.

/// Returns a vector for Box2D, whose numbers are floats.
b2Vec2 ToBox(double x, double y);

/// Gives a body the pieces of a solid as seen from a point that Box2D counts from.
/// Throws std::invalid_argument on a piece that is not convex, counter-clockwise and of 3 to 8 corners.
void AddPieces(b2Body* body, const Solid& solid, const base::Point& origin);

/// Gives a body the shape and mass [kg] of a disc.
void AddDisc(b2Body* body, double radius, double mass);

/// Gives a body the shape and mass [kg] of a convex polygon in its own frame.
void AddPolygon(b2Body* body, const Polygon& corners, double mass);

}  // namespace robotteamsim::world
