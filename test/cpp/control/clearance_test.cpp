#include "robotteamsim/control/clearance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robotteamsim::control {
namespace {

const double kPi = std::acos(-1.0);

/// Three beams: right, ahead, left; 5 m at most.
ScanClearance ThreeBeams(double forward_m = 0.0) { return ScanClearance({3, -kPi / 2, kPi / 2, forward_m, 5.0}); }

TEST(ScanClearance, RefusesAScanOfAnotherLength) {
  EXPECT_THROW(ThreeBeams().Hits(std::vector<float>{1.0F, 1.0F}, 5.0), std::invalid_argument);
  EXPECT_THROW(ScanClearance({0, 0.0, 1.0, 0.0, 5.0}), std::invalid_argument);
}

TEST(ScanClearance, HitsLeaveOutBeamsWithoutReturn) {
  const float none = std::numeric_limits<float>::infinity();
  const std::vector<base::Point> hits = ThreeBeams(0.1).Hits(std::vector<float>{5.0F, 1.0F, none}, 5.0);
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_NEAR(hits[0].x, 1.1, 1e-12);
  EXPECT_NEAR(hits[0].y, 0.0, 1e-12);
  EXPECT_TRUE(ThreeBeams().Hits(std::vector<float>{2.0F, 2.0F, 2.0F}, 1.9).empty());
}

TEST(ScanClearance, HitsOfALaserBesideTheAxisAreInBaseLink) {
  const ScanClearance beside({3, -kPi / 2, kPi / 2, 0.1, 5.0, 0.3});
  const std::vector<base::Point> hits = beside.Hits(std::vector<float>{1.0F, 5.0F, 4.5F}, 5.0);
  ASSERT_EQ(hits.size(), 2U);
  EXPECT_NEAR(hits[0].y, 0.3 - 1.0, 1e-12);
  EXPECT_NEAR(hits[1].y, 0.3 + 4.5, 1e-12);
}

/// What FreeDistance returns, one hit after the other, for a laser at base_link.
double PlainFreeDistance(const std::vector<base::Point>& hits, double heading_rad, double radius_m,
                         double max_distance_m) {
  double free = max_distance_m;
  for (const base::Point& hit : hits) {
    const double along = hit.x * std::cos(heading_rad) + hit.y * std::sin(heading_rad);
    const double across = hit.y * std::cos(heading_rad) - hit.x * std::sin(heading_rad);
    if (along <= 0.0 || radius_m * radius_m - across * across <= 0.0) continue;
    const double touch = along - std::sqrt(radius_m * radius_m - across * across);
    if (touch < 0.0 && along * along > 0.25 * (along * along + across * across)) return 0.0;
    if (touch >= 0.0 && touch < free) free = touch;
  }
  return free;
}

TEST(ScanClearance, FreeDistanceOfRandomScansIsThatOfThePlainFormula) {
  std::mt19937 random(5);  // NOLINT(bugprone-random-generator-seed): the same scans in each run
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int blocked = 0, partly_free = 0;
  for (int beams = 1; beams < 150; ++beams) {
    const ScanClearance clearance({beams, -kPi / 2, kPi / 2, 0.0, 5.0});
    const double nearest = 0.15 + 0.5 * uniform(random);
    std::vector<float> ranges;
    for (int i = 0; i < beams; ++i) ranges.push_back(static_cast<float>(nearest + uniform(random)));
    const std::vector<base::Point> hits = clearance.Hits(ranges, 5.0);
    ASSERT_EQ(static_cast<int>(hits.size()), beams);
    for (int i = 0; i < 20; ++i) {
      const double heading_rad = 2.0 * kPi * (uniform(random) - 0.5);
      const double plain = PlainFreeDistance(hits, heading_rad, 0.25, 0.7);
      EXPECT_EQ(clearance.FreeDistance(ranges, heading_rad, 0.25, 0.7), plain);
      EXPECT_EQ(clearance.FreeDistances(ranges, {Direction(heading_rad)}, 0.25, 0.7).front(), plain);
      blocked += plain == 0.0;
      partly_free += plain > 0.0 && plain < 0.7;
    }
  }
  EXPECT_GT(blocked, 50);
  EXPECT_GT(partly_free, 500);
}

TEST(ScanClearance, DiscStopsWhereItTouchesTheHit) {
  const std::vector<float> ranges = {5.0F, 1.0F, 5.0F};
  EXPECT_NEAR(ThreeBeams().FreeDistance(ranges, 0.0, 0.2, 3.0), 0.8, 1e-9);
  // 0.1 m beside the hit: the disc touches it sqrt(0.2^2 - 0.1^2) before the foot of the perpendicular.
  const double heading_rad = std::asin(0.1);
  EXPECT_NEAR(ThreeBeams().FreeDistance(ranges, heading_rad, 0.2, 3.0), std::cos(heading_rad) - std::sqrt(0.03), 1e-6);
  EXPECT_EQ(ThreeBeams().FreeDistance(ranges, 0.3, 0.2, 3.0), 3.0);
  EXPECT_EQ(ThreeBeams().FreeDistance(ranges, kPi, 0.2, 3.0), 3.0);
}

TEST(ScanClearance, DiscSlidesAlongAWallThatItTouches) {
  const std::vector<float> wall_on_the_left = {5.0F, 5.0F, 0.15F};
  EXPECT_EQ(ThreeBeams().FreeDistance(wall_on_the_left, 0.0, 0.2, 1.0), 1.0);
  EXPECT_EQ(ThreeBeams().FreeDistance(wall_on_the_left, kPi / 2, 0.2, 1.0), 0.0);
  EXPECT_EQ(ThreeBeams().FreeDistance(wall_on_the_left, -kPi / 2, 0.2, 1.0), 1.0);
}

TEST(ScanClearance, SeveralHeadingsGiveWhatEachGives) {
  const std::vector<float> ranges = {0.5F, 1.0F, 2.0F};
  const std::vector<double> headings_rad = {-1.5, 0.0, 1.5};
  const std::vector<double> free =
      ThreeBeams().FreeDistances(ranges, {headings_rad.begin(), headings_rad.end()}, 0.25, 3.0);
  for (std::size_t i = 0; i < headings_rad.size(); ++i) {
    EXPECT_EQ(free[i], ThreeBeams().FreeDistance(ranges, headings_rad[i], 0.25, 3.0));
  }
}

/// 181 beams over the half plane ahead, and a post of 0.1 m radius, `distance` ahead and `left` of the middle.
std::vector<float> PostAhead(double distance, double left = 0.0) {
  std::vector<float> ranges;
  for (int i = 0; i < 181; ++i) {
    const double angle = (i - 90) * kPi / 180.0, middle = std::atan2(left, distance);
    const bool hits = std::abs(angle - middle) < 0.1 / distance;
    ranges.push_back(hits ? static_cast<float>(std::hypot(distance, left)) : 5.0F);
  }
  return ranges;
}

Sidestepper HalfPlane(std::vector<double> headings_rad) {
  return {ScanClearance({181, -kPi / 2, kPi / 2, 0.0, 5.0}), std::move(headings_rad), {0.25, 0.35, 1.6}};
}

TEST(Sidestepper, TakesTheWantedHeadingWhereItIsFreeOrBehind) {
  Sidestepper robot = HalfPlane({-1.0, 1.0});
  EXPECT_EQ(robot.Find(PostAhead(3.0), 0.1, 0.2, 0.5).heading_rad, 0.1);
  EXPECT_EQ(robot.Find(PostAhead(0.4), 2.0, 0.2, 0.5).heading_rad, 2.0);
}

TEST(Sidestepper, PassesOnTheRightAndStaysOnASideOnceBegun) {
  Sidestepper robot = HalfPlane({-1.2, 0.0, 1.0});
  EXPECT_EQ(robot.Find(PostAhead(0.4), 0.0, 0.2, 0.5).heading_rad, -1.2);
  // Now the left would be nearer by more than what keeping right weighs.
  EXPECT_EQ(robot.Find(PostAhead(0.4), 0.15, 0.2, 0.5).heading_rad, -1.2);
  Sidestepper another = HalfPlane({-1.2, 0.0, 1.0});
  EXPECT_EQ(another.Find(PostAhead(0.4), 0.15, 0.2, 0.5).heading_rad, 1.0);
}

TEST(Sidestepper, TakesTheFarthestFreeWhereNoneIsFreeAsFarAsNeeded) {
  Sidestepper robot = HalfPlane({0.0, 0.3});
  const Sidestepper::FreeHeading found = robot.Find(PostAhead(0.4), 0.0, 0.25, 0.5);
  EXPECT_EQ(found.heading_rad, 0.3);
  EXPECT_GT(found.free_m, 0.1);
  EXPECT_LT(found.free_m, 0.5);
  EXPECT_THROW(HalfPlane({}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::control
