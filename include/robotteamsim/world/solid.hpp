#pragma once

#include <vector>

#include "robotteamsim/plan/types.hpp"

namespace robotteamsim {

/// A polygon in the map frame: corners counter-clockwise, not closed [m].
using Polygon = std::vector<Point>;

/// Something that robots cannot enter. Box2D needs it in convex pieces; sensors look at the outline.
struct Solid {
  Polygon outline;
  std::vector<Polygon> pieces;  ///< convex, 3 to 8 corners each, together the outline's inside
};

/// A door leaf; it is there only while the door is closed.
struct Door {
  Solid leaf;
  bool closed = false;
};

}  // namespace robotteamsim
