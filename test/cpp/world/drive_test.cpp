#include "robotteamsim/world/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);

TEST(ReachedSpeed, ChangesByAccelerationTimesTime) {
  const DriveSpeed speed = ReachedSpeed({0.1, -0.5}, {0.7, 0.0, 2.0}, {0.7, 2.0, 2.0, 8.0}, 0.02);
  EXPECT_DOUBLE_EQ(speed.forward_mps, 0.14);
  EXPECT_DOUBLE_EQ(speed.turn_radps, -0.34);
}

TEST(ReachedSpeed, StaysWithinTheSpeedLimits) {
  const DriveLimits limits{0.7, 2.0, 100.0, 1000.0};
  const DriveSpeed speed = ReachedSpeed({0.0, 0.0}, {-9.0, 5.0, 9.0}, limits, 0.1);
  EXPECT_DOUBLE_EQ(speed.forward_mps, -0.7);
  EXPECT_DOUBLE_EQ(speed.turn_radps, 2.0);
}

TEST(AdvancedPose, OfQuarterCircleHasItsRadius) {
  const base::Pose pose = AdvancedPose({0.0, 0.0, 0.0}, {kPi, kPi / 2.0}, 1.0);  // radius v / w = 2
  EXPECT_NEAR(pose.x, 2.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.0, 1e-12);
  EXPECT_NEAR(pose.yaw, kPi / 2.0, 1e-12);
}

DriveLimits OmniLimits() { return {1.0, 2.0, 2.0, 8.0, DriveKind::kOmni}; }

DriveLimits CarLimits() { return {1.0, 0.0, 2.0, 0.0, DriveKind::kCar, 0.5, 0.6, 2.0}; }

TEST(ReachedSpeed, OfOmniDriveKeepsTheDirectionOfWhatIsBeyondItsSpeed) {
  DriveLimits limits = OmniLimits();
  limits.max_acceleration_mps2 = 1000.0;
  const DriveSpeed speed = ReachedSpeed({}, {3.0, 4.0, 0.0}, limits, 0.1);
  EXPECT_NEAR(speed.forward_mps, 0.6, 1e-12);
  EXPECT_NEAR(speed.left_mps, 0.8, 1e-12);
}

TEST(ReachedSpeed, OfOmniDriveChangesByAccelerationTimesTimeInAnyDirection) {
  const DriveSpeed speed = ReachedSpeed({0.3, 0.0, 0.4}, {0.3, -0.9, 0.0}, OmniLimits(), 0.1);
  EXPECT_DOUBLE_EQ(speed.forward_mps, 0.3);
  EXPECT_NEAR(speed.left_mps, 0.2, 1e-12);
}

TEST(ReachedSpeed, OfCarNeverTurnsOnTheSpot) {
  const DriveSpeed speed = ReachedSpeed({}, {0.0, 0.0, 2.0}, CarLimits(), 0.1);
  EXPECT_EQ(speed.turn_radps, 0.0);
  EXPECT_EQ(speed.steering_rad, 0.0);
}

TEST(ReachedSpeed, OfCarTurnsAsWantedWithinItsSteering) {
  DriveSpeed speed;
  for (int i = 0; i < 50; ++i) speed = ReachedSpeed(speed, {1.0, 0.0, 0.8}, CarLimits(), 0.1);
  EXPECT_NEAR(speed.turn_radps, 0.8, 1e-12);
  EXPECT_NEAR(speed.steering_rad, std::atan(0.5 * 0.8 / 1.0), 1e-12);
  for (int i = 0; i < 50; ++i) speed = ReachedSpeed(speed, {1.0, 0.0, -9.0}, CarLimits(), 0.1);
  EXPECT_NEAR(speed.turn_radps, -1.0 * std::tan(0.6) / 0.5, 1e-12);
}

TEST(ReachedSpeed, OfCarSteersTheOtherWayInReverse) {
  DriveSpeed speed;
  for (int i = 0; i < 50; ++i) speed = ReachedSpeed(speed, {-1.0, 0.0, 0.8}, CarLimits(), 0.1);
  EXPECT_NEAR(speed.turn_radps, 0.8, 1e-12);
  EXPECT_LT(speed.steering_rad, 0.0);
}

TEST(ReachedSpeed, OfCarSteersNoFasterThanItsRate) {
  const DriveSpeed speed = ReachedSpeed({1.0}, {1.0, 0.0, 5.0}, CarLimits(), 0.1);
  EXPECT_DOUBLE_EQ(speed.steering_rad, 0.2);
}

TEST(SpeedBound, CountsSidewaysCommandsOfOmniDrivesOnly) {
  EXPECT_DOUBLE_EQ(SpeedBound({}, {0.3, 0.4, 0.0}, OmniLimits()), 0.5);
  EXPECT_DOUBLE_EQ(SpeedBound({}, {0.3, 0.4, 0.0}, DriveLimits{}), 0.3);
  EXPECT_DOUBLE_EQ(SpeedBound({0.6, 0.0, 0.8}, {9.0, 0.0, 0.0}, OmniLimits()), 1.0);
}

TEST(DriveKindOf, KnowsThreeNames) {
  EXPECT_EQ(DriveKindOf("differential"), DriveKind::kDifferential);
  EXPECT_EQ(DriveKindOf("omni"), DriveKind::kOmni);
  EXPECT_EQ(DriveKindOf("car"), DriveKind::kCar);
  EXPECT_THROW(DriveKindOf("Car"), std::invalid_argument);
}

TEST(CheckDrive, RefusesCarsWithoutWheelbaseAndWheelsSteeredToARightAngle) {
  DriveLimits limits = CarLimits();
  EXPECT_NO_THROW(CheckDrive(limits));
  limits.max_steering_rad = 0.5 * kPi;
  EXPECT_THROW(CheckDrive(limits), std::invalid_argument);
  limits = CarLimits();
  limits.wheelbase_m = 0.0;
  EXPECT_THROW(CheckDrive(limits), std::invalid_argument);
}

TEST(AdvancedPose, OfSidewaysDriveOnAQuarterCircleEndsWhereItsArcDoes) {
  // Leftward at pi m/s, turning by pi/2: a circle of radius 2 around (-2, 0).
  const base::Pose pose = AdvancedPose({0.0, 0.0, 0.0}, {0.0, kPi / 2.0, kPi}, 1.0);
  EXPECT_NEAR(pose.x, -2.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.0, 1e-12);
  EXPECT_NEAR(pose.yaw, kPi / 2.0, 1e-12);
}

TEST(AdvancedPose, OfStraightDriveFollowsTheHeading) {
  const base::Pose pose = AdvancedPose({1.0, 1.0, kPi / 2.0}, {-0.5, 0.0}, 2.0);
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 0.0, 1e-12);
}

}  // namespace
}  // namespace robotteamsim::world
