#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "robotteamsim/world/world.hpp"

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);
const base::Twist kForward{0.7, 0.0, 0.0};
const Polygon kCrate{{-0.3, -0.2}, {0.3, -0.2}, {0.3, 0.2}, {-0.3, 0.2}};

Robot RobotAt(double x, double y, double yaw) {
  Robot robot;
  robot.start = {x, y, yaw};
  return robot;
}

World WorldOf(std::vector<Robot> robots, std::vector<MovableObject> objects) {
  const Polygon wall{{5.0, -5.0}, {5.2, -5.0}, {5.2, 5.0}, {5.0, 5.0}};
  return World({{wall, {wall}}}, {}, std::move(robots), 0.1, 5, std::move(objects));
}

void Drive(World& world, const std::vector<base::Twist>& commands, int steps) {
  for (int i = 0; i < steps; ++i) world.Step(commands);
}

TEST(MovableObjects, StandExactlyWhereTheyArePlacedUntilTheyArePushed) {
  World world = WorldOf({RobotAt(0.0, 0.0, kPi)}, {{0.3, 2.0, 0.5, {2.1, 0.3, 0.7}, {}}});
  Drive(world, {{}}, 20);
  EXPECT_EQ(world.object_poses()[0].x, 2.1);
  EXPECT_EQ(world.object_poses()[0].y, 0.3);
  EXPECT_EQ(world.object_poses()[0].yaw, 0.7);
}

TEST(MovableObjects, GoOnByTheirMomentumAsFarAsTheGroundLetsThem) {
  World world = WorldOf({RobotAt(0.0, 0.0, 0.0)}, {{0.3, 2.0, 0.1, {1.0, 0.0, 0.0}, {}}});
  Drive(world, {kForward}, 30);
  const double let_go = world.object_poses()[0].x, speed = world.twists()[0].linear_x;
  EXPECT_NEAR(speed, 0.7 - 0.1 * 9.81 * 2.0 * 0.02 / 5.0, 1e-3);
  Drive(world, {{-0.7, 0.0, 0.0}}, 20);
  EXPECT_NEAR(world.object_poses()[0].x, let_go + speed * speed / (2.0 * 0.1 * 9.81), 0.01);
}

TEST(MovableObjects, TurnWhenTheyArePushedAtTheirEnd) {
  World world = WorldOf({RobotAt(0.0, 0.0, 0.0)}, {{0.0, 2.0, 0.5, {1.0, 0.25, kPi / 2.0}, kCrate}});
  Drive(world, {kForward}, 30);
  EXPECT_GT(world.object_poses()[0].yaw, kPi / 2.0 + 0.2);
}

TEST(MovableObjects, StayBetweenRobotAndWall) {
  World world = WorldOf({RobotAt(2.0, 0.0, 0.0)}, {{0.0, 2.0, 0.5, {3.0, 0.0, 0.0}, kCrate}});
  Drive(world, {kForward}, 100);
  EXPECT_NEAR(world.object_poses()[0].x, 4.7, 0.01);
  EXPECT_NEAR(world.poses()[0].x, 4.2, 0.02);
}

TEST(MovableObjects, PushOtherObjects) {
  World world =
      WorldOf({RobotAt(0.0, 0.0, 0.0)}, {{0.3, 1.0, 0.5, {1.0, 0.0, 0.0}, {}}, {0.3, 1.0, 0.5, {1.7, 0.0, 0.0}, {}}});
  Drive(world, {kForward}, 40);
  EXPECT_NEAR(world.object_poses()[1].x - world.object_poses()[0].x, 0.6, 0.01);
}

TEST(MovableObjects, ThatDoNotExistAreNeitherMovedNorRemoved) {
  World world = WorldOf({}, {{0.3, 2.0, 0.5, {1.0, 2.0, 0.0}, {}}});
  for (const int object : {-1, 1}) {
    EXPECT_THROW(world.RemoveObject(object), std::out_of_range);
    EXPECT_THROW(world.SetObjectPose(object, {0.0, 0.0, 0.0}), std::out_of_range);
  }
  ASSERT_EQ(world.object_poses().size(), 1U);
  EXPECT_EQ(world.object_poses()[0].x, 1.0);
  world.RemoveObject(0);
  EXPECT_THROW(world.RemoveObject(0), std::out_of_range);
}

TEST(MovableObjects, WithoutMassOrGroundAreRefused) {
  EXPECT_THROW(WorldOf({}, {{0.3, 0.0, 0.5, {}, {}}}), std::invalid_argument);
  EXPECT_THROW(WorldOf({}, {{0.3, 1.0, 0.0, {}, {}}}), std::invalid_argument);
  EXPECT_THROW(WorldOf({}, {{0.3, 1.0, 0.5, {}, {{0.0, 0.0}, {1.0, 0.0}}}}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::world
