#pragma once

#include <vector>

#include "robotteamsim/plan/types.hpp"

namespace robotteamsim {

/// Returns the distance between a point and the nearest point of a segment [m].
double DistanceToSegment(const Point& point, const Segment& segment);

/// Which segments are near a point: each square cell of the floor keeps the list for all points in it.
class NearbySegments {
 public:
  /// Args: reach: how far `Near` looks [m]. Throws std::invalid_argument unless it is above 0.
  NearbySegments(std::vector<Segment> segments, double reach);

  /// Returns all segments within reach of the point, and some that are a little farther, in no particular order.
  const std::vector<Segment>& Near(const Point& point) const;

 private:
  int Column(double x) const;
  int Row(double y) const;
  void AddToCells(const Segment& segment, double reach);

  Point origin_;
  double cell_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<Segment>> cells_;
  std::vector<Segment> all_;  // for points beside the cells
};

}  // namespace robotteamsim
