#pragma once

#include "robotteamsim/world/solid.hpp"

class b2Body;
struct b2Vec2;

namespace robotteamsim::world {

// Box2D bodies for the parts of a world.

/// Returns a vector for Box2D, whose numbers are floats.
b2Vec2 ToBox(double x, double y);

/// Adds the pieces of a solid to a body, relative to an origin.
/// Throws std::invalid_argument if a piece is not convex and counter-clockwise with 3 to 8 corners.
void AddPieces(b2Body* body, const Solid& solid, const base::Point& origin);

/// Gives a body the shape and mass [kg] of a disc.
void AddDisc(b2Body* body, double radius_m, double mass_kg);

/// Gives a body the shape and mass [kg] of a convex polygon in its own frame.
void AddPolygon(b2Body* body, const Polygon& corners, double mass_kg);

}  // namespace robotteamsim::world
