#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/solid.hpp"

namespace robotteamsim::world {

/// A side of an outline: the solid is to the left, seen from a to b.
struct Edge {
  static constexpr int kNoDoor = -1;

  base::Segment segment;
  int door = kNoDoor;  ///< the door of which it is a leaf's side; it exists only while that door is closed
};

/// Returns the distance between a point and the nearest point of a segment [m].
double DistanceToSegment(const base::Point& point, const base::Segment& segment);

/// Returns the sides of all solids and of the leaves that do not swing or slide.
std::vector<Edge> EdgesOf(const std::vector<Solid>& solids, const std::vector<Door>& doors);

/// Finds the edges near a point: each square cell of the floor keeps a list for all points in it.
class NearbyEdges {
 public:
  /// Args: reach_m: of `Near` [m]. Throws std::invalid_argument if it is not above 0.
  NearbyEdges(std::vector<Edge> edges, double reach_m);

  /// Returns all edges within reach of the point and some beyond it, in no particular order.
  const std::vector<Edge>& Near(const base::Point& point) const;

 private:
  int Column(double x) const;
  int Row(double y) const;
  void AddToCells(const Edge& edge, double reach_m);

  base::Point origin_;
  double cell_m_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<Edge>> cells_;
  std::vector<Edge> all_;  // for points outside of the cells
};

}  // namespace robotteamsim::world
