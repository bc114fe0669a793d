#include "robotteamsim/world/nearby_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

namespace robotteamsim::world {
namespace {

bool Holds(const std::vector<Edge>& edges, const base::Segment& wanted) {
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    const base::Segment& segment = edge.segment;
    return segment.a.x == wanted.a.x && segment.a.y == wanted.a.y && segment.b.x == wanted.b.x &&
           segment.b.y == wanted.b.y;
  });
}

/// Expects every edge within 3 m of a point in its list.
void ExpectNoneMissed(const NearbyEdges& nearby, const std::vector<Edge>& edges, const base::Point& point) {
  const std::vector<Edge>& near = nearby.Near(point);
  for (const Edge& edge : edges) {
    EXPECT_TRUE(DistanceToSegment(point, edge.segment) > 3.0 || Holds(near, edge.segment));
  }
}

/// Returns the sides of a rectangle and of one within it, 10 m from it.
std::vector<Edge> SidesOfTwoRectangles(double size) {
  std::vector<Edge> edges;
  for (const double shift : {0.0, 10.0}) {
    const base::Point low{shift, shift}, high{size - shift, 0.5 * size - shift};
    edges.push_back({{low, {high.x, low.y}}});
    edges.push_back({{{high.x, low.y}, high}});
    edges.push_back({{high, {low.x, high.y}}});
    edges.push_back({{{low.x, high.y}, low}});
  }
  return edges;
}

/// Returns points along each side of those rectangles, on both sides of it.
std::vector<base::Point> PointsBesideSides(double size) {
  std::vector<base::Point> points;
  for (const double along : {-0.01, 0.0, 0.01, 0.37, 0.5, 0.99, 1.0, 1.01}) {
    for (const double beside : {-2.9, 0.0, 2.9, 7.1, 12.9}) {
      points.push_back({along * size, beside});
      points.push_back({along * size, 0.5 * size - beside});
      points.push_back({beside, 0.5 * along * size});
      points.push_back({size - beside, 0.5 * along * size});
    }
  }
  return points;
}

TEST(DistanceToSegment, IsThatToTheNearestOfSideAndEnds) {
  const base::Segment segment{{1.0, 1.0}, {4.0, 1.0}};
  EXPECT_DOUBLE_EQ(DistanceToSegment({2.0, 3.0}, segment), 2.0);
  EXPECT_DOUBLE_EQ(DistanceToSegment({-2.0, 5.0}, segment), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToSegment({7.0, -3.0}, segment), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToSegment({4.0, 5.0}, {{1.0, 1.0}, {1.0, 1.0}}), 5.0);
}

TEST(NearbyEdges, MissesNoEdgeWithinReach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(0.0, 30.0), offset(-4.0, 4.0);
  std::vector<Edge> edges;
  for (int i = 0; i < 200; ++i) {
    const base::Point a{coordinate(random), coordinate(random)};
    edges.push_back({{a, {a.x + offset(random), a.y + offset(random)}}});
  }
  const NearbyEdges nearby(edges, 3.0);
  std::size_t listed = 0;
  for (int i = 0; i < 500; ++i) {
    const base::Point point{coordinate(random) - 1.0, coordinate(random) - 1.0};
    listed += nearby.Near(point).size();
    ExpectNoneMissed(nearby, edges, point);
  }
  EXPECT_LT(listed, 500U * 40U);  // and it does leave far ones out
}

TEST(NearbyEdges, MissesNoEdgeOfFewOverALargeArea) {
  for (const double size : {1e3, 1e6, 1e9}) {
    const std::vector<Edge> edges = SidesOfTwoRectangles(size);
    const NearbyEdges nearby(edges, 3.0);
    for (const base::Point& point : PointsBesideSides(size)) ExpectNoneMissed(nearby, edges, point);
  }
}

TEST(NearbyEdges, OfNothingAreNone) {
  const NearbyEdges nearby({}, 3.0);
  EXPECT_TRUE(nearby.Near({1.0, 2.0}).empty());
}

TEST(NearbyEdges, RefusesAReachOfZero) { EXPECT_THROW(NearbyEdges({}, 0.0), std::invalid_argument); }

}  // namespace
}  // namespace robotteamsim::world
