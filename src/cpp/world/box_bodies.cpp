#include "robotteamsim/world/box_bodies.hpp"

#include <box2d/box2d.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "robotteamsim/world/outline.hpp"

namespace robotteamsim::world {
namespace {

// Box2D lets shapes at rest overlap by one slop (5 mm). Each shape is larger by half a slop, so that the bodies do not
// overlap: they rest at most a slop apart.
constexpr float kSkin = 0.5F * b2_linearSlop;

// Fills the shape directly: b2PolygonShape::Set merges corners nearer than 2.5 mm and replaces a degenerate polygon by
// a box of two metres, so thin solids would differ from the plan.
b2PolygonShape ConvexShape(const Polygon& piece, const base::Point& origin) {
  const int count = static_cast<int>(piece.size());
  if (count < 3 || count > b2_maxPolygonVertices) {
    throw std::invalid_argument("a convex piece needs 3 to 8 corners, got " + std::to_string(count));
  }
  b2PolygonShape shape;
  shape.m_radius = kSkin;
  shape.m_count = count;
  for (int i = 0; i < count; ++i) {
    const base::Point& corner = piece[i];
    const base::Point& next = piece[(i + 1) % count];
    const double dx = next.x - corner.x, dy = next.y - corner.y, length = std::hypot(dx, dy);
    if (!(length > 0.0) || !(Cross(corner, next, piece[(i + 2) % count]) >= 0.0)) {
      throw std::invalid_argument("a piece must be convex and counter-clockwise, without equal corners");
    }
    shape.m_vertices[i] = ToBox(corner.x - origin.x, corner.y - origin.y);
    shape.m_normals[i] = ToBox(dy / length, -dx / length);
    shape.m_centroid += 1.0F / static_cast<float>(count) * shape.m_vertices[i];
  }
  return shape;
}

void AddFixture(b2Body* body, const b2Shape& shape, double density) {
  b2FixtureDef fixture;
  fixture.shape = &shape;
  fixture.friction = 0.0F;
  fixture.density = static_cast<float>(density);
  body->CreateFixture(&fixture);
}

}  // namespace

b2Vec2 ToBox(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

void AddPieces(b2Body* body, const Solid& solid, const base::Point& origin) {
  for (const Polygon& piece : solid.pieces) {
    AddFixture(body, ConvexShape(piece, origin), 0.0);
  }
}

void AddDisc(b2Body* body, double radius_m, double mass_kg) {
  b2CircleShape shape;
  shape.m_radius = static_cast<float>(radius_m) + kSkin;
  AddFixture(body, shape, mass_kg / (static_cast<double>(b2_pi) * shape.m_radius * shape.m_radius));
}

void AddPolygon(b2Body* body, const Polygon& corners, double mass_kg) {
  double twice_area = 0.0;
  for (std::size_t i = 2; i < corners.size(); ++i) twice_area += Cross(corners[0], corners[i - 1], corners[i]);
  AddFixture(body, ConvexShape(corners, {}), 2.0 * mass_kg / twice_area);
}

}  // namespace robotteamsim::world
