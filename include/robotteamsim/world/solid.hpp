#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::world {

/// A polygon in the map frame: corners counter-clockwise, not closed [m].
using Polygon = std::vector<base::Point>;

/// Something that robots cannot enter. Box2D needs it in convex pieces; sensors look at the outline.
struct Solid {
  Polygon outline;
  std::vector<Polygon> pieces;  ///< convex, 3 to 8 corners each, together the outline's inside
};

/// How the leaf of a door moves, at an even pace: it turns about its hinge, or shifts, or both.
struct LeafMotion {
  double time = 0.0;  ///< from closed to open [s]; 0: at once, and then the leaf is there only while the door is closed
  double angle = 0.0;  ///< by which an open leaf has turned about the hinge, counter-clockwise [rad]
  base::Point shift;   ///< by which an open leaf has shifted [m]
  base::Point hinge;   ///< [m]
};

/// A door: a leaf that is across its gap while the door is closed.
struct Door {
  Solid leaf;           ///< where it is while the door is closed
  bool closed = false;  ///< whether the leaf is all across its gap: what bodies, beams, radio and voices go by
  LeafMotion motion = {};
};

}  // namespace robotteamsim::world
