#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

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
  if (body.footprint.empty()) return GapBetween(leaf, base::Point{pose.x, pose.y}) - body.radius_m;
  return GapBetween(leaf, Placed(body.footprint, pose));
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
  door.motion.time_s = 0.1;
  World world = WorldOf(door, {RobotAt(0.6, 0.5, 0.0)});
  world.SetDoorClosed(0, true);
  Step(world, 1);
  EXPECT_TRUE(world.leaves()[0].is_held);
  EXPECT_GT(GapToRobot(world, 0), 0.0);
}

TEST(Doors, HaveANameForEachActivity) {
  EXPECT_STREQ(NameOf(LeafActivity::kStill), "still");
  EXPECT_STREQ(NameOf(LeafActivity::kOpens), "opens");
  EXPECT_STREQ(NameOf(LeafActivity::kCloses), "closes");
  EXPECT_STREQ(NameOf(LeafActivity::kHeld), "held");
}

TEST(Doors, WithAMotionThatCannotBeAreRefused) {
  Door door = SwingDoor(true);
  door.motion.time_s = -1.0;
  EXPECT_THROW(WorldOf(door, {}), std::invalid_argument);
  door.motion.time_s = 1.0;
  door.motion.angle_rad = std::nan("");
  EXPECT_THROW(WorldOf(door, {}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::world
