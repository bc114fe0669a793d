#include "robotteamsim/world/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace robotteamsim {
namespace {

const double kPi = std::acos(-1.0);

TEST(NormaliseAngle, KeepsPiAndTurnsMinusPiIntoIt) {
  EXPECT_DOUBLE_EQ(NormaliseAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(NormaliseAngle(-kPi), kPi);
  EXPECT_DOUBLE_EQ(NormaliseAngle(5.0 * kPi / 2.0), kPi / 2.0);
}

TEST(RelativePose, IsSeenFromTheFirstPose) {
  const Pose way = RelativePose({1.0, 2.0, kPi / 2.0}, {0.0, 5.0, -kPi});
  EXPECT_NEAR(way.x, 3.0, 1e-12);
  EXPECT_NEAR(way.y, 1.0, 1e-12);
  EXPECT_NEAR(way.yaw, kPi / 2.0, 1e-12);
}

TEST(ReachedSpeed, ChangesByAccelerationTimesTime) {
  const DriveSpeed speed = ReachedSpeed({0.1, -0.5}, {0.7, 0.0, 2.0}, {0.7, 2.0, 2.0, 8.0}, 0.02);
  EXPECT_DOUBLE_EQ(speed.forward, 0.14);
  EXPECT_DOUBLE_EQ(speed.turn, -0.34);
}

TEST(ReachedSpeed, StaysWithinTheSpeedLimits) {
  const DriveLimits limits{0.7, 2.0, 100.0, 1000.0};
  const DriveSpeed speed = ReachedSpeed({0.0, 0.0}, {-9.0, 5.0, 9.0}, limits, 0.1);
  EXPECT_DOUBLE_EQ(speed.forward, -0.7);
  EXPECT_DOUBLE_EQ(speed.turn, 2.0);
}

TEST(AdvancedPose, OfQuarterCircleHasItsRadius) {
  const Pose pose = AdvancedPose({0.0, 0.0, 0.0}, {kPi, kPi / 2.0}, 1.0);  // radius v / w = 2
  EXPECT_NEAR(pose.x, 2.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.0, 1e-12);
  EXPECT_NEAR(pose.yaw, kPi / 2.0, 1e-12);
}

TEST(AdvancedPose, OfStraightDriveFollowsTheHeading) {
  const Pose pose = AdvancedPose({1.0, 1.0, kPi / 2.0}, {-0.5, 0.0}, 2.0);
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 0.0, 1e-12);
}

}  // namespace
}  // namespace robotteamsim
