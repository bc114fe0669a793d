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
    const std::vector<Edge>& near = nearby.Near(point);
    listed += near.size();
    for (const Edge& edge : edges) {
      EXPECT_TRUE(DistanceToSegment(point, edge.segment) > 3.0 || Holds(near, edge.segment));
    }
  }
  EXPECT_LT(listed, 500U * 40U);  // and it does leave far ones out
}

TEST(NearbyEdges, MissesNoEdgeOfFewOverALargeArea) {
  for (const double size : {1e3, 1e6, 1e9}) {
    std::vector<Edge> edges;
    for (const double shift : {0.0, 10.0}) {  // the sides of two rectangles, one within the other
      const base::Point low{shift, shift}, high{size - shift, 0.5 * size - shift};
      edges.push_back({{low, {high.x, low.y}}});
      edges.push_back({{{high.x, low.y}, high}});
      edges.push_back({{high, {low.x, high.y}}});
      edges.push_back({{{low.x, high.y}, low}});
    }
    const NearbyEdges nearby(edges, 3.0);
    for (const double along : {-0.01, 0.0, 0.01, 0.37, 0.5, 0.99, 1.0, 1.01}) {
      for (const double beside : {-2.9, 0.0, 2.9, 7.1, 12.9}) {
        for (const base::Point point :
             {base::Point{along * size, beside}, base::Point{along * size, 0.5 * size - beside},
              base::Point{beside, 0.5 * along * size}, base::Point{size - beside, 0.5 * along * size}}) {
          const std::vector<Edge>& near = nearby.Near(point);
          for (const Edge& edge : edges) {
            EXPECT_TRUE(DistanceToSegment(point, edge.segment) > 3.0 || Holds(near, edge.segment));
          }
        }
      }
    }
  }
}

TEST(NearbyEdges, OfNothingAreNone) {
  const NearbyEdges nearby({}, 3.0);
  EXPECT_TRUE(nearby.Near({1.0, 2.0}).empty());
}

TEST(NearbyEdges, RefusesAReachOfZero) { EXPECT_THROW(NearbyEdges({}, 0.0), std::invalid_argument); }

}  // namespace
}  // namespace robotteamsim::world
