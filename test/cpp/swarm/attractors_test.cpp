#include "robotteamsim/swarm/attractors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace robotteamsim::swarm {
namespace {

const std::vector<base::Point> kCandidates{{1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}};

TEST(FarthestFrom, IsTheCandidateFarthestFromThePoints) {
  EXPECT_EQ(FarthestFrom({{1.5, 0.0}, {0.0, 1.4}}, {0.0, 0.0}, kCandidates), 2);
}

TEST(FarthestFrom, IsNoneAtTheBestPlaceOrWithoutPointsOrCandidates) {
  std::vector<base::Point> ring, half;
  for (int i = 0; i < 36; ++i) {
    ring.push_back({std::cos(i * M_PI / 18.0), std::sin(i * M_PI / 18.0)});
    half.push_back({0.5 * ring.back().x, 0.5 * ring.back().y});
  }
  EXPECT_EQ(FarthestFrom(ring, {0.0, 0.0}, half), -1);
  EXPECT_EQ(FarthestFrom(ring, {0.0, 0.0}, {}), -1);
  EXPECT_EQ(FarthestFrom({}, {0.3, 0.4}, kCandidates), -1);
}

TEST(FarthestFrom, IsTheFirstOfEqualCandidatesAndNoneThatEqualsThePlace) {
  EXPECT_EQ(FarthestFrom({{2.0, 0.0}}, {0.0, 0.0}, kCandidates), 1);
  EXPECT_EQ(FarthestFrom({{0.5, 0.0}}, {0.4, 0.0}, {{0.0, 0.0}, {1.0, 0.0}}), 0);
  EXPECT_EQ(FarthestFrom({{0.5, 0.0}}, {0.0, 0.0}, {{1.0, 0.0}}), -1);
}

TEST(FarthestFrom, IsTheLargestOfAllLeastDistances) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
  const auto drawn = [&](int count) {
    std::vector<base::Point> points(count);
    for (base::Point& point : points) point = {anywhere(generator), anywhere(generator)};
    return points;
  };
  for (int i = 0; i < 200; ++i) {
    const std::vector<base::Point> points = drawn(20), candidates = drawn(9);
    const auto clearance = [&](const base::Point& place) {
      double least = 10.0;
      for (const base::Point& point : points) least = std::min(least, std::hypot(place.x - point.x, place.y - point.y));
      return least;
    };
    const int best = FarthestFrom(points, {0.1, 0.2}, candidates);
    const double farthest = clearance(best < 0 ? base::Point{0.1, 0.2} : candidates[best]);
    EXPECT_GE(farthest, clearance({0.1, 0.2}));
    for (const base::Point& candidate : candidates) EXPECT_GE(farthest, clearance(candidate));
  }
}

}  // namespace
}  // namespace robotteamsim::swarm
