#include "robotteamsim/maps/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rooms.hpp"

namespace robotteamsim::maps {
namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

/// Beams to the right, ahead and to the left, from 0.1 m ahead of the robot's centre.
ScanLayout ThreeBeams() {
  const double right_angle = std::acos(0.0);
  return {{3, -right_angle, right_angle, 0.1, 0.0, 5.0}, 0.05, 181};
}

TEST(ReadScan, HasHitsWhereBeamsEndAndFreeSpaceWhereNoneReturns) {
  const Scan scan = ReadScan(ThreeBeams(), {2.0F, 5.0F, kInfinity}, {});
  ASSERT_EQ(scan.hits.size(), 1U);
  EXPECT_NEAR(scan.hits[0].at.x, 0.1, 1e-6);
  EXPECT_NEAR(scan.hits[0].at.y, -2.0, 1e-6);
  ASSERT_EQ(scan.free_ends.size(), 2U);
  EXPECT_NEAR(scan.free_ends[0].x, 5.0, 1e-6);  // 0.1 m before range_max
  EXPECT_NEAR(scan.free_ends[1].y, 4.9, 1e-6);
}

TEST(ReadScan, LeavesOutWhatIsMaskedTooNearOrNoNumber) {
  const Scan scan = ReadScan(ThreeBeams(), {0.05F, kNan, 2.0F}, {0, 0, 1});
  EXPECT_TRUE(scan.hits.empty());
  EXPECT_TRUE(scan.free_ends.empty());
}

TEST(ReadScan, UsesEveryNthBeamOfAScanWithMore) {
  const world::Fan fan = RoundFan(5.0, 361);
  const std::vector<float> ranges(361, 2.0F);
  EXPECT_EQ(ReadScan({fan, 0.0, 181}, ranges, {}).hits.size(), 181U);
  EXPECT_EQ(ReadScan({fan, 0.0, 180}, ranges, {}).hits.size(), 121U);
}

TEST(ReadScan, HasNormalsTowardsTheRobotOnBothSidesOfAWall) {
  const Walls wall{{{2.0, -3.0}, {2.0, 3.0}}};
  for (const double x : {0.0, 4.0}) {
    const Scan scan = ScanIn(wall, {x, 0.0, 0.0});
    ASSERT_FALSE(scan.hits.empty());
    for (const SurfacePoint& hit : scan.hits) EXPECT_NEAR(hit.normal.x, x < 2.0 ? -1.0 : 1.0, 1e-3);
  }
}

TEST(ReadScan, HasNoNormalForAHitWithoutNeighbours) {
  const Scan scan = ReadScan(ThreeBeams(), {2.0F, 5.0F, 5.0F}, {});
  EXPECT_EQ(scan.hits[0].normal.x, 0.0);
  EXPECT_EQ(scan.hits[0].normal.y, 0.0);
}

TEST(ReadScan, RefusesArraysOfAnotherLength) {
  EXPECT_THROW(ReadScan(ThreeBeams(), {2.0F}, {}), std::invalid_argument);
  EXPECT_THROW(ReadScan(ThreeBeams(), {2.0F, 2.0F, 2.0F}, {0}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
