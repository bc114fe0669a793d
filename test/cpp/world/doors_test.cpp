#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "robotteamsim/sensing/laser.hpp"
#include "robotteamsim/world/outline.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);

Polygon Rectangle(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

// By so much [m] may robots that push each other press one into what stands still.
const double kPressed = 0.01;

// A leaf of 1 m from its hinge (0, 0) along x, closed, that swings to the left within two seconds.
Door SwingDoor(bool closed) {
  const Polygon leaf = Rectangle(0.0, -0.03, 1.0, 0.03);
  return {{leaf, {leaf}}, closed, {2.0, 0.5 * kPi, {}, {0.0, 0.0}}};
}

Door SlideDoor(bool closed) {
  const Polygon leaf = Rectangle(0.0, -0.03, 1.0, 0.03);
  return {{leaf, {leaf}}, closed, {1.0, 0.0, {-1.0, 0.0}, {0.0, 0.0}}};
}

Robot RobotAt(double x, double y, double yaw, Polygon footprint = {}) {
  Robot robot;
  robot.start = {x, y, yaw};
  robot.footprint = std::move(footprint);
  return robot;
}

World WorldOf(const Door& door, std::vector<Robot> robots, std::vector<MovableObject> objects = {}) {
  return World({}, {door}, std::move(robots), 0.1, 5, std::move(objects));
}

void Step(World& world, int steps, const base::Twist& twist = {}) {
  for (int i = 0; i < steps; ++i) world.Step(std::vector<base::Twist>(world.robots().size(), twist));
}

double GapToRobot(const World& world, int robot) {
  const Polygon& leaf = world.leaves()[0].outline;
  const base::Pose& pose = world.poses()[robot];
  const Robot& body = world.robots()[robot];
  if (body.footprint.empty()) return GapBetween(leaf, base::Point{pose.x, pose.y}) - body.radius;
  return GapBetween(leaf, Placed(body.footprint, pose));
}

TEST(Doors, SwingAtAnEvenPaceFromClosedToOpenAndBack) {
  World world = WorldOf(SwingDoor(true), {RobotAt(0.0, -3.0, 0.0)});
  world.SetDoorClosed(0, false);
  EXPECT_TRUE(world.doors()[0].closed);
  Step(world, 1);
  EXPECT_FALSE(world.doors()[0].closed);
  EXPECT_NEAR(world.leaves()[0].opening, 0.05, 1e-12);
  Step(world, 9);
  const Polygon leaf = Placed(Rectangle(0.0, -0.03, 1.0, 0.03), {0.0, 0.0, 0.25 * kPi});
  EXPECT_NEAR(world.leaves()[0].outline[2].x, leaf[2].x, 1e-9);
  EXPECT_NEAR(world.leaves()[0].outline[2].y, leaf[2].y, 1e-9);
  Step(world, 10);
  EXPECT_EQ(world.leaves()[0].opening, 1.0);
  world.SetDoorClosed(0, true);
  Step(world, 19);
  EXPECT_FALSE(world.doors()[0].closed);
  Step(world, 1);
  EXPECT_TRUE(world.doors()[0].closed);
  EXPECT_EQ(world.leaves()[0].opening, 0.0);
}

TEST(Doors, TurnBackOnTheirWay) {
  World world = WorldOf(SlideDoor(true), {RobotAt(0.0, -3.0, 0.0)});
  world.SetDoorClosed(0, false);
  Step(world, 4);
  EXPECT_NEAR(world.leaves()[0].outline[0].x, -0.4, 1e-9);
  world.SetDoorClosed(0, true);
  Step(world, 4);
  EXPECT_EQ(world.leaves()[0].opening, 0.0);
  EXPECT_TRUE(world.doors()[0].closed);
}

TEST(Doors, WaitForARobotInTheWayWithoutMovingItAndGoOnWhenItHasGone) {
  for (const Polygon& footprint : {Polygon{}, Rectangle(-0.2, -0.1, 0.3, 0.1)}) {
    World world = WorldOf(SwingDoor(false), {RobotAt(0.6, 0.5, 0.3, footprint)});
    world.SetDoorClosed(0, true);
    Step(world, 40);
    EXPECT_TRUE(world.leaves()[0].is_held);
    EXPECT_FALSE(world.doors()[0].closed);
    EXPECT_GT(GapToRobot(world, 0), 0.0);
    EXPECT_LT(GapToRobot(world, 0), 0.016);
    EXPECT_EQ(world.poses()[0].x, 0.6);
    EXPECT_EQ(world.poses()[0].y, 0.5);
    EXPECT_EQ(world.poses()[0].yaw, 0.3);
    world.SetPose(0, {3.0, 3.0, 0.0});
    Step(world, 20);
    EXPECT_FALSE(world.leaves()[0].is_held);
    EXPECT_TRUE(world.doors()[0].closed);
  }
}

TEST(Doors, WaitForAnObjectInTheWayWithoutMovingIt) {
  World world = WorldOf(SwingDoor(false), {RobotAt(0.0, -3.0, 0.0)}, {{0.2, 1.0, 0.1, {0.7, 0.2, 0.0}, {}}});
  world.SetDoorClosed(0, true);
  Step(world, 40);
  EXPECT_TRUE(world.leaves()[0].is_held);
  EXPECT_EQ(world.object_poses()[0].x, 0.7);
  EXPECT_EQ(world.object_poses()[0].y, 0.2);
}

TEST(Doors, LetGoOfARobotThatLeansOnThem) {
  World world = WorldOf(SwingDoor(true), {RobotAt(0.5, -0.5, 0.5 * kPi)});
  Step(world, 10, {0.7, 0.0, 0.0});
  EXPECT_TRUE(world.in_contact()[0]);
  world.SetDoorClosed(0, false);
  Step(world, 20, {0.7, 0.0, 0.0});
  EXPECT_EQ(world.leaves()[0].opening, 1.0);
  EXPECT_GT(world.poses()[0].y, 0.5);
}

TEST(Doors, NeverSqueezeCrowdsThatDriveAboutThem) {
  std::vector<Robot> robots;
  for (int i = 0; i < 12; ++i) robots.push_back(RobotAt(-1.0 + 0.5 * (i % 4), 0.4 + 0.5 * (i / 4), i));
  World world = WorldOf(SwingDoor(true), robots);
  for (int step = 0; step < 600; ++step) {
    if (step % 25 == 0) world.SetDoorClosed(0, step % 50 == 0);
    std::vector<base::Twist> twists;
    for (int i = 0; i < 12; ++i) {
      // Toward the hinge, each with its own turns.
      const base::Pose& pose = world.poses()[i];
      const double wanted = std::atan2(0.3 - pose.y, 0.4 - pose.x) + std::sin(0.1 * step + i);
      twists.push_back({0.7, 0.0, 2.0 * base::NormaliseAngle(wanted - pose.yaw)});
    }
    world.Step(twists);
    for (int i = 0; i < 12; ++i) EXPECT_GT(GapToRobot(world, i), -kPressed) << "step " << step << ", robot " << i;
  }
}

TEST(Doors, StopFastLeavesBeforeWhatIsInTheirWay) {
  Door door = SwingDoor(false);
  door.motion.time = 0.1;
  World world = WorldOf(door, {RobotAt(0.6, 0.5, 0.0)});
  world.SetDoorClosed(0, true);
  Step(world, 1);
  EXPECT_TRUE(world.leaves()[0].is_held);
  EXPECT_GT(GapToRobot(world, 0), 0.0);
}

TEST(Doors, StopRobotsAndBeamsWhereTheLeafIs) {
  World world = WorldOf(SwingDoor(true), {RobotAt(0.5, -1.0, 0.5 * kPi), RobotAt(-1.0, 0.5, 0.0)});
  sensing::LaserModel model;
  model.beams = 1;
  const sensing::Laser laser(model, world);
  EXPECT_NEAR(laser.Scan(world, 0)[0], 0.97, 1e-9);
  EXPECT_EQ(laser.Scan(world, 1)[0], std::numeric_limits<double>::infinity());
  world.SetDoorClosed(0, false);
  Step(world, 20);
  EXPECT_EQ(laser.Scan(world, 0)[0], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(laser.Scan(world, 1)[0], 0.97, 1e-9);
  Step(world, 30, {0.7, 0.0, 0.0});
  EXPECT_GT(world.poses()[0].y, 0.9);
  EXPECT_NEAR(world.poses()[1].x, -0.23, 0.006);
  EXPECT_TRUE(world.in_contact()[1]);
}

TEST(Doors, AreTheSameAgainAfterAReset) {
  const auto run = [](World& world) {
    std::vector<base::Pose> ways;
    for (int step = 0; step < 60; ++step) {
      if (step == 5 || step == 35) world.SetDoorClosed(0, step == 35);
      world.Step({{0.7, 0.0, 0.3}, {0.5, 0.0, -0.2}});
      ways.insert(ways.end(), world.poses().begin(), world.poses().end());
      ways.push_back({world.leaves()[0].opening, 0.0, 0.0});
    }
    return ways;
  };
  World world = WorldOf(SwingDoor(true), {RobotAt(0.5, -0.6, 1.5), RobotAt(-1.0, 0.4, 0.0)});
  const std::vector<base::Pose> first = run(world);
  world.Reset();
  EXPECT_TRUE(world.doors()[0].closed);
  const std::vector<base::Pose> again = run(world);
  ASSERT_EQ(first.size(), again.size());
  EXPECT_EQ(std::memcmp(first.data(), again.data(), first.size() * sizeof(base::Pose)), 0);
}

TEST(Doors, HaveANameForEachActivity) {
  EXPECT_STREQ(NameOf(LeafActivity::kStill), "still");
  EXPECT_STREQ(NameOf(LeafActivity::kOpens), "opens");
  EXPECT_STREQ(NameOf(LeafActivity::kCloses), "closes");
  EXPECT_STREQ(NameOf(LeafActivity::kHeld), "held");
}

TEST(Doors, WithAMotionThatCannotBeAreRefused) {
  Door door = SwingDoor(true);
  door.motion.time = -1.0;
  EXPECT_THROW(WorldOf(door, {}), std::invalid_argument);
  door.motion.time = 1.0;
  door.motion.angle = std::nan("");
  EXPECT_THROW(WorldOf(door, {}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::world
