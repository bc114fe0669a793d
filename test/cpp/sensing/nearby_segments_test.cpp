#include "robotteamsim/sensing/nearby_segments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

namespace robotteamsim {
namespace {

bool Holds(const std::vector<Segment>& segments, const Segment& wanted) {
  return std::any_of(segments.begin(), segments.end(), [&](const Segment& segment) {
    return segment.a.x == wanted.a.x && segment.a.y == wanted.a.y && segment.b.x == wanted.b.x &&
           segment.b.y == wanted.b.y;
  });
}

TEST(DistanceToSegment, IsThatToTheNearestOfSideAndEnds) {
  const Segment segment{{1.0, 1.0}, {4.0, 1.0}};
  EXPECT_DOUBLE_EQ(DistanceToSegment({2.0, 3.0}, segment), 2.0);
  EXPECT_DOUBLE_EQ(DistanceToSegment({-2.0, 5.0}, segment), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToSegment({7.0, -3.0}, segment), 5.0);
  EXPECT_DOUBLE_EQ(DistanceToSegment({4.0, 5.0}, {{1.0, 1.0}, {1.0, 1.0}}), 5.0);
}

TEST(NearbySegments, MissesNoSegmentWithinReach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(0.0, 30.0), offset(-4.0, 4.0);
  std::vector<Segment> segments;
  for (int i = 0; i < 200; ++i) {
    const Point a{coordinate(random), coordinate(random)};
    segments.push_back({a, {a.x + offset(random), a.y + offset(random)}});
  }
  const NearbySegments nearby(segments, 3.0);
  std::size_t listed = 0;
  for (int i = 0; i < 500; ++i) {
    const Point point{coordinate(random) - 1.0, coordinate(random) - 1.0};
    const std::vector<Segment>& near = nearby.Near(point);
    listed += near.size();
    for (const Segment& segment : segments) {
      EXPECT_TRUE(DistanceToSegment(point, segment) > 3.0 || Holds(near, segment));
    }
  }
  EXPECT_LT(listed, 500U * 40U);  // and it does leave far ones out
}

TEST(NearbySegments, OfNothingAreNone) {
  const NearbySegments nearby({}, 3.0);
  EXPECT_TRUE(nearby.Near({1.0, 2.0}).empty());
}

TEST(NearbySegments, RefusesAReachOfZero) { EXPECT_THROW(NearbySegments({}, 0.0), std::invalid_argument); }

}  // namespace
}  // namespace robotteamsim
