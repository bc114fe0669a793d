#pragma once

namespace robotteamsim {

/// A point in the map frame [m].
struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// A straight segment from a to b in the map frame [m].
struct Segment {
  Point a;
  Point b;
};

}  // namespace robotteamsim
