#include "robotteamsim/world/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);
const double kStep = 0.1;
const int kSubsteps = 5;
const double kTouch = 0.005;  // bodies that touch are less apart
const base::Twist kForward{0.7, 0.0, 0.0};

Solid Rectangle(double x0, double y0, double x1, double y1) {
  const Polygon corners{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  return {corners, {corners}};
}

Robot RobotAt(double x, double y, double yaw) {
  Robot robot;
  robot.start = {x, y, yaw};
  return robot;
}

// A room of 6 x 4 m with walls of 0.1 m.
std::vector<Solid> Room() {
  return {Rectangle(-0.1, -0.1, 6.1, 0.0), Rectangle(-0.1, 4.0, 6.1, 4.1), Rectangle(-0.1, 0.0, 0.0, 4.0),
          Rectangle(6.0, 0.0, 6.1, 4.0)};
}

void Drive(World& world, const std::vector<base::Twist>& commands, int steps) {
  for (int i = 0; i < steps; ++i) world.Step(commands);
}

bool SameBits(const std::vector<base::Pose>& a, const std::vector<base::Pose>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(base::Pose)) == 0;
}

std::vector<base::Twist> RandomCommands(std::mt19937& random, std::size_t count) {
  std::vector<base::Twist> commands(count);
  for (base::Twist& command : commands) {
    command.linear_x = random() % 3 == 0 ? -0.7 : 0.7;
    command.angular_z = static_cast<double>(random() % 5) - 2.0;
  }
  return commands;
}

TEST(World, MovesAFreeRobotExactlyAsItsDriveSays) {
  World world({}, {}, {RobotAt(1.1, 2.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {kForward}, 100);
  // 0.7 m/s is reached in 18 substeps: 0.04, 0.08 .. 0.68, 0.7 m/s.
  const double start_up = 0.02 * (0.04 * 17 * 18 / 2);
  EXPECT_NEAR(world.poses()[0].x, 1.1 + start_up + 0.7 * 0.02 * (500 - 17), 1e-11);
  EXPECT_EQ(world.poses()[0].y, 2.0);
  EXPECT_NEAR(world.twists()[0].linear_x, 0.7, 1e-12);
  EXPECT_EQ(world.twists()[0].linear_y, 0.0);
  EXPECT_FALSE(world.in_contact()[0]);
}

TEST(World, GivesHeadingsWithinHalfATurnFromTheStart) {
  const World world({}, {}, {RobotAt(0.0, 0.0, 3.0 * kPi / 2.0)}, kStep, kSubsteps);
  EXPECT_DOUBLE_EQ(world.poses()[0].yaw, -kPi / 2.0);
}

TEST(World, AcceleratesWithinItsLimits) {
  World world({}, {}, {RobotAt(0.0, 0.0, 0.0)}, kStep, kSubsteps);
  world.Step({{5.0, 0.0, 50.0}});
  EXPECT_NEAR(world.twists()[0].linear_x, 0.12, 1e-12);   // mean of 0.04 .. 0.20
  EXPECT_NEAR(world.twists()[0].angular_z, 0.48, 1e-12);  // mean of 0.16 .. 0.80
  Drive(world, {{5.0, 0.0, 50.0}}, 20);
  EXPECT_NEAR(world.twists()[0].linear_x, 0.7, 1e-12);
  EXPECT_NEAR(world.twists()[0].angular_z, 2.0, 1e-12);
}

TEST(World, DrivesACircleOfRadiusSpeedOverTurn) {
  World world({}, {}, {RobotAt(3.0, 3.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {{0.5, 0.0, 1.0}}, 10);
  const base::Pose& pose = world.poses()[0];
  const double center_x = pose.x - 0.5 * std::sin(pose.yaw), center_y = pose.y + 0.5 * std::cos(pose.yaw);
  for (int i = 0; i < 100; ++i) {
    world.Step({{0.5, 0.0, 1.0}});
    EXPECT_NEAR(std::hypot(pose.x - center_x, pose.y - center_y), 0.5, 1e-9);
    EXPECT_GT(pose.yaw, -kPi);
    EXPECT_LE(pose.yaw, kPi);
  }
}

TEST(World, ReportsTheWayOfTheLastStep) {
  World world({}, {}, {RobotAt(3.0, 3.0, 2.0)}, kStep, kSubsteps);
  Drive(world, {{0.5, 0.0, 1.0}}, 10);
  const base::Pose before = world.poses()[0];
  world.Step({{0.5, 0.0, 1.0}});
  const base::Pose expected = base::RelativePose(before, world.poses()[0]);
  EXPECT_EQ(world.motions()[0].x, expected.x);
  EXPECT_EQ(world.motions()[0].y, expected.y);
  EXPECT_NEAR(world.motions()[0].yaw, 0.1, 1e-12);
}

TEST(World, StopsARobotAtAWallWhereItTouches) {
  World world(Room(), {}, {RobotAt(4.0, 2.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {kForward}, 60);
  EXPECT_NEAR(world.poses()[0].x, 5.8, kTouch);
  EXPECT_NEAR(world.poses()[0].y, 2.0, 1e-6);
  EXPECT_TRUE(world.in_contact()[0]);
  const base::Pose before = world.poses()[0];
  world.Step({kForward});
  EXPECT_NEAR(world.twists()[0].linear_x, 0.0, 1e-6);
  EXPECT_EQ(world.twists()[0].linear_y, 0.0);
  EXPECT_NEAR(world.poses()[0].x, before.x, 1e-7);
}

TEST(World, LetsARobotSlideAlongAWall) {
  World world(Room(), {}, {RobotAt(2.0, 3.0, kPi / 4.0)}, kStep, kSubsteps);
  Drive(world, {kForward}, 40);
  EXPECT_NEAR(world.poses()[0].y, 3.8, kTouch);
  // Of 0.7 m/s, the part along the wall: 0.7 cos(45 deg), seen at 45 degrees in base_link.
  EXPECT_NEAR(world.twists()[0].linear_x, 0.35, 1e-3);
  EXPECT_NEAR(world.twists()[0].linear_y, -0.35, 1e-3);
  EXPECT_EQ(world.poses()[0].yaw, kPi / 4.0);
}

TEST(World, LetsABlockedRobotDriveAwayAtOnce) {
  World world(Room(), {}, {RobotAt(5.0, 2.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {kForward}, 40);
  world.Step({{-0.7, 0.0, 0.0}});
  EXPECT_NEAR(world.twists()[0].linear_x, -0.12, 0.05);
}

TEST(World, IsAsExactInCoordinatesOfANationalGrid) {
  const double east = 500000.0, north = 4600000.0;
  World world({Rectangle(east + 5.0, north, east + 5.1, north + 4.0)}, {}, {RobotAt(east + 3.0, north + 2.0, 0.0)},
              kStep, kSubsteps);
  Drive(world, {kForward}, 60);
  EXPECT_NEAR(world.poses()[0].x - east, 4.8, kTouch);
  EXPECT_NEAR(world.poses()[0].y - north, 2.0, 1e-6);
}

TEST(World, LetsARobotPushAnotherButNotSpeedItUp) {
  World world(Room(), {}, {RobotAt(2.0, 2.0, 0.0), RobotAt(2.5, 2.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {kForward, {}}, 30);
  EXPECT_GT(world.poses()[1].x, 2.51);
  EXPECT_LT(world.twists()[1].linear_x, 0.35);
  Drive(world, {{-0.7, 0.0, 0.0}, {}}, 5);
  const base::Pose left_alone = world.poses()[1];
  world.Step({{-0.7, 0.0, 0.0}, {}});
  EXPECT_EQ(world.poses()[1].x, left_alone.x);
}

TEST(World, LetsNoRobotOutOfARoomWhateverTheCommands) {
  std::vector<Robot> robots;
  for (int i = 0; i < 6; ++i) robots.push_back(RobotAt(0.6 + 0.8 * i, 1.0 + 0.3 * i, i));
  World world(Room(), {}, robots, kStep, kSubsteps);
  std::mt19937 random(7);
  std::vector<base::Twist> commands = RandomCommands(random, robots.size());
  for (int i = 0; i < 20000; ++i) {
    if (i % 20 == 0) commands = RandomCommands(random, robots.size());
    world.Step(commands);
    for (const base::Pose& pose : world.poses()) {
      ASSERT_GT(pose.x, 0.19) << "step " << i;
      ASSERT_LT(pose.x, 5.81) << "step " << i;
      ASSERT_GT(pose.y, 0.19) << "step " << i;
      ASSERT_LT(pose.y, 3.81) << "step " << i;
    }
  }
}

TEST(World, PutsARobotSomewhereStandingStill) {
  World world(Room(), {}, {RobotAt(2.0, 2.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {kForward}, 10);
  world.SetPose(0, {5.7, 3.0, 3.0 * kPi});
  EXPECT_EQ(world.poses()[0].x, 5.7);
  EXPECT_DOUBLE_EQ(world.poses()[0].yaw, kPi);
  EXPECT_EQ(world.motions()[0].x, 0.0);
  world.Step({{}});
  EXPECT_EQ(world.poses()[0].x, 5.7);
  Drive(world, {{-0.7, 0.0, 0.0}}, 20);
  EXPECT_NEAR(world.poses()[0].x, 5.8, kTouch);  // the wall is felt at the new place too
}

// Base_link in the middle of a body of 0.8 x 0.4 m.
Robot BoxAt(double x, double y, double yaw) {
  Robot robot = RobotAt(x, y, yaw);
  robot.footprint = {{-0.4, -0.2}, {0.4, -0.2}, {0.4, 0.2}, {-0.4, 0.2}};
  return robot;
}

TEST(World, MovesAFreePolygonAsItMovesADisc) {
  World world({}, {}, {BoxAt(0.0, 0.0, 0.3)}, kStep, kSubsteps);
  World round({}, {}, {RobotAt(0.0, 0.0, 0.3)}, kStep, kSubsteps);
  for (World* each : {&world, &round}) Drive(*each, {{0.5, 0.0, 1.0}}, 50);
  EXPECT_TRUE(SameBits(world.poses(), round.poses()));
  EXPECT_DOUBLE_EQ(world.robots()[0].radius_m, std::hypot(0.4, 0.2));
}

TEST(World, StopsAPolygonWhereItsSideTouches) {
  World world(Room(), {}, {BoxAt(4.0, 2.0, 0.0)}, kStep, kSubsteps);
  Drive(world, {kForward}, 40);
  EXPECT_NEAR(world.poses()[0].x, 5.6, kTouch);
  EXPECT_NEAR(world.poses()[0].yaw, 0.0, 1e-3);
  EXPECT_TRUE(world.in_contact()[0]);
}

TEST(World, LetsNoWallTurnAPolygonThatTurnsAgainstIt) {
  // Along a wall, 5 cm from it: its corners are in the way.
  World world(Room(), {}, {BoxAt(3.0, 0.25, 0.0), RobotAt(3.0, 0.85, 0.0)}, kStep, kSubsteps);
  Drive(world, {{0.0, 0.0, 1.0}, {}}, 3);
  EXPECT_GT(world.poses()[0].yaw, 0.02);
  World corridor({Rectangle(-5.0, -0.1, 5.0, 0.0), Rectangle(-5.0, 0.5, 5.0, 0.6)}, {}, {BoxAt(0.0, 0.25, 0.0)}, kStep,
                 kSubsteps);
  Drive(corridor, {{0.0, 0.0, 1.0}}, 50);
  // Between walls 0.5 m apart it can turn until its corners touch both: 0.8 sin a + 0.4 cos a = 0.5.
  EXPECT_NEAR(corridor.poses()[0].yaw, 0.128, 0.02);
  EXPECT_TRUE(corridor.in_contact()[0]);
  const double yaw = corridor.poses()[0].yaw;
  Drive(corridor, {{0.0, 0.0, 1.0}}, 50);
  EXPECT_NEAR(corridor.poses()[0].yaw, yaw, 0.005);
}

TEST(World, LetsARobotTurnAPolygonThatItPushesAtItsEnd) {
  World world({}, {}, {BoxAt(0.0, 0.0, 0.0), RobotAt(0.35, -0.6, kPi / 2.0)}, kStep, kSubsteps);
  Drive(world, {{}, kForward}, 20);
  EXPECT_GT(world.poses()[0].yaw, 0.3);
  EXPECT_TRUE(world.in_contact()[0]);
}

TEST(World, LetsNoPolygonOutOfARoomWhateverTheCommands) {
  std::mt19937 random(7);
  World world(Room(), {}, {BoxAt(1.0, 1.0, 0.0), BoxAt(3.0, 1.0, 1.0), BoxAt(5.0, 3.0, 2.0), RobotAt(2.0, 3.0, 0.0)},
              kStep, kSubsteps);
  for (int i = 0; i < 200; ++i) {
    Drive(world, RandomCommands(random, 4), 10);
    for (std::size_t robot = 0; robot < 4; ++robot) {
      const base::Pose& pose = world.poses()[robot];
      const Polygon round{{pose.x - 0.2, pose.y - 0.2}, {pose.x + 0.2, pose.y + 0.2}};
      for (const base::Point& corner : robot < 3 ? Placed(world.robots()[robot].footprint, pose) : round) {
        ASSERT_TRUE(corner.x > -0.02 && corner.x < 6.02 && corner.y > -0.02 && corner.y < 4.02) << i;
      }
    }
  }
}

TEST(World, TurnsABlockedCarOnlyAsFarAsItsWheelsRoll) {
  Robot car = BoxAt(5.5, 2.0, 0.0);
  car.drive = {0.7, 0.0, 2.0, 0.0, DriveKind::kCar, 0.3, 0.6, 2.0};
  World world(Room(), {}, {car}, kStep, kSubsteps);
  Drive(world, {{0.7, 0.0, 0.0}}, 20);
  Drive(world, {{0.7, 0.0, 2.0}}, 20);
  EXPECT_NEAR(world.poses()[0].yaw, 0.0, 0.05);
}

TEST(World, RefusesFootprintsThatAreNoBodyAroundBaseLink) {
  Robot robot = BoxAt(0.0, 0.0, 0.0);
  std::reverse(robot.footprint.begin(), robot.footprint.end());
  EXPECT_THROW(World({}, {}, {robot}, kStep, kSubsteps), std::invalid_argument);
  robot.footprint = {{0.1, -0.2}, {0.4, -0.2}, {0.4, 0.2}};
  EXPECT_THROW(World({}, {}, {robot}, kStep, kSubsteps), std::invalid_argument);
}

TEST(World, SpawnedRobotIsPushedLikeOneThatWasAlwaysThere) {
  Robot absent = RobotAt(2.0, 2.0, 0.0);
  absent.is_present = false;
  World world(Room(), {}, {RobotAt(1.0, 2.0, 0.0), absent}, kStep, kSubsteps);
  World always(Room(), {}, {RobotAt(1.0, 2.0, 0.0), RobotAt(2.0, 2.0, 0.0)}, kStep, kSubsteps);
  world.SpawnRobot(1, {2.0, 2.0, 0.0});
  for (int step_s = 0; step_s < 30; ++step_s) {
    world.Step({kForward, {}});
    always.Step({kForward, {}});
    EXPECT_TRUE(SameBits(world.poses(), always.poses()));
  }
  EXPECT_GT(world.poses()[1].x, 2.1);
}

TEST(World, RefusesPiecesThatBox2dCannotTake) {
  const Polygon clockwise{{0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}};
  const Polygon line{{0.0, 0.0}, {1.0, 0.0}};
  EXPECT_THROW(World({{clockwise, {clockwise}}}, {}, {}, kStep, kSubsteps), std::invalid_argument);
  EXPECT_THROW(World({{line, {line}}}, {}, {}, kStep, kSubsteps), std::invalid_argument);
  EXPECT_THROW(World({}, {}, {}, 0.0, kSubsteps), std::invalid_argument);
  EXPECT_THROW(World({}, {}, {}, kStep, 0), std::invalid_argument);
  Robot flat;
  flat.radius_m = 0.0;
  EXPECT_THROW(World({}, {}, {flat}, kStep, kSubsteps), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::world
