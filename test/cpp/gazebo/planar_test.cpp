#include "planar.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace robotteamsim::gazebo_plugins {
namespace {

TEST(Velocity, OfARobotOnACircleIsAlongItsHeading) {
  const double speed = 0.7;
  for (const double turn : {2.0, -2.0}) {
    const double yaw = 0.1 * turn;
    const PlanarPose motion{speed / turn * std::sin(yaw), speed / turn * (1.0 - std::cos(yaw)), yaw};
    const PlanarTwist velocity = Velocity(motion, 0.1);
    EXPECT_NEAR(velocity.forward_mps, speed, 1e-12);
    EXPECT_NEAR(velocity.left_mps, 0.0, 1e-12);
    EXPECT_NEAR(velocity.turn_radps, turn, 1e-12);
  }
}

TEST(Velocity, WithoutATurnIsTheMotionOverTheTime) {
  const PlanarTwist velocity = Velocity({0.05, -0.02, 0.0}, 0.1);
  EXPECT_NEAR(velocity.forward_mps, 0.5, 1e-12);
  EXPECT_NEAR(velocity.left_mps, -0.2, 1e-12);
  EXPECT_EQ(velocity.turn_radps, 0.0);
}

}  // namespace
}  // namespace robotteamsim::gazebo_plugins
