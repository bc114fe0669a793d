#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::world {

/// A polygon in the map frame: corners counter-clockwise, not closed [m].
using Polygon = std::vector<base::Point>;

/// A solid that robots cannot enter. Box2D needs convex pieces; sensors use the outline.
struct Solid {
  Polygon outline;
  std::vector<Polygon> pieces;  ///< convex, 3 to 8 corners each; their union is the inside of the outline
};

/// The motion of a leaf, at constant speed: it turns about its hinge, or shifts, or both.
struct LeafMotion {
  double time_s = 0.0;     ///< from closed to open; 0: instantly, and the leaf exists only while the door is closed
  double angle_rad = 0.0;  ///< by which an open leaf has turned about the hinge, counter-clockwise
  base::Point shift;       ///< by which an open leaf has shifted [m]
  base::Point hinge;       ///< [m]
};

/// A door: a leaf that covers its gap while the door is closed.
struct Door {
  Solid leaf;           ///< where it is while the door is closed
  bool closed = false;  ///< whether the leaf covers the whole gap; bodies, beams, radio and voices use this
  LeafMotion motion = {};
};

}  // namespace robotteamsim::world
