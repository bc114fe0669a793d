#include "robotteamsim/world/fan_caster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);
const double kInfinity = std::numeric_limits<double>::infinity();

Fan FanOf(int beams, double angle_min_rad, double angle_max_rad, double forward_m) {
  return {beams, angle_min_rad, angle_max_rad, forward_m};
}

Solid Rectangle(double x0, double y0, double x1, double y1) {
  const Polygon corners{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  return {corners, {corners}};
}

Robot RobotAt(double x, double y, double yaw) {
  Robot robot;
  robot.start = {x, y, yaw};
  return robot;
}

World WorldOf(const std::vector<Solid>& solids, const std::vector<Robot>& robots, const std::vector<Door>& doors = {}) {
  return World(solids, doors, robots, 0.1, 5);
}

TEST(FanCaster, MeasuresAWallAheadByDistanceOverCosine) {
  const World world = WorldOf({Rectangle(3.0, -10.0, 3.2, 10.0)}, {RobotAt(1.0, 0.0, 0.0)});
  const std::vector<double> ranges_m = FanCaster(FanOf(181, -kPi / 2.0, kPi / 2.0, 0.0), world).Cast(world, 0);
  ASSERT_EQ(ranges_m.size(), 181U);
  EXPECT_NEAR(ranges_m[90], 2.0, 1e-12);
  EXPECT_NEAR(ranges_m[90 + 60], 4.0, 1e-12);
  EXPECT_NEAR(ranges_m[90 - 60], 4.0, 1e-12);
  EXPECT_NEAR(ranges_m[90 + 66], 2.0 / std::cos(66.0 * kPi / 180.0), 1e-12);
  EXPECT_EQ(ranges_m[90 + 67], kInfinity);  // 5.12 m
  EXPECT_EQ(ranges_m[180], kInfinity);      // along the wall
}

TEST(FanCaster, StandsForwardOfTheRobotAndTurnsWithIt) {
  const World world = WorldOf({Rectangle(-1.0, 3.0, 1.0, 3.2)}, {RobotAt(0.0, 0.0, kPi / 2.0)});
  const FanCaster caster(FanOf(1, 0.0, 0.0, 0.1), world);
  EXPECT_NEAR(caster.Cast(world, 0)[0], 2.9, 1e-12);
}

TEST(FanCaster, SeesOtherRobotsAsDiscsAndNotItsOwn) {
  const World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0), RobotAt(2.0, 0.0, 0.0)});
  const FanCaster caster(FanOf(3, -0.05, 0.05, 0.1), world);
  const std::vector<double> ranges_m = caster.Cast(world, 0);
  EXPECT_NEAR(ranges_m[1], 1.7, 1e-12);
  const double along = 1.9 * std::cos(0.05), across = 1.9 * std::sin(0.05);
  EXPECT_NEAR(ranges_m[2], along - std::sqrt(0.04 - across * across), 1e-12);
  EXPECT_EQ(caster.Cast(world, 1)[1], kInfinity);
}

TEST(FanCaster, SeesTheSidesOfRobotsWithCorners) {
  Robot box = RobotAt(2.0, 0.0, kPi / 2.0);
  box.footprint = {{-0.5, -0.1}, {0.5, -0.1}, {0.5, 0.3}, {-0.5, 0.3}};  // turned: 0.3 to the left is towards us
  const World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0), box});
  const FanCaster caster(FanOf(3, -0.2, 0.2, 0.0), world);
  const std::vector<double> ranges_m = caster.Cast(world, 0);
  EXPECT_NEAR(ranges_m[1], 1.7, 1e-12);
  EXPECT_NEAR(ranges_m[0], 1.7 / std::cos(0.2), 1e-12);
  EXPECT_EQ(caster.Cast(world, 1)[1], kInfinity);
}

TEST(FanCaster, SeesTheNearestOfAll) {
  const World world = WorldOf({Rectangle(4.0, -1.0, 4.2, 1.0), Rectangle(1.0, -0.1, 1.2, 0.1)},
                              {RobotAt(0.0, 0.0, 0.0), RobotAt(2.0, 0.0, 0.0)});
  EXPECT_NEAR(FanCaster(FanOf(1, 0.0, 0.0, 0.0), world).Cast(world, 0)[0], 1.0, 1e-12);
}

TEST(FanCaster, SeesClosedDoorsOnly) {
  World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0)}, {{Rectangle(2.0, -1.0, 2.06, 1.0), false}});
  const FanCaster caster(FanOf(1, 0.0, 0.0, 0.0), world);
  EXPECT_EQ(caster.Cast(world, 0)[0], kInfinity);
  world.SetDoorClosed(0, true);
  EXPECT_NEAR(caster.Cast(world, 0)[0], 2.0, 1e-12);
}

TEST(FanCaster, LetsNoBeamThroughACornerWhereWallsMeet) {
  // Two walls that share the edge (2, 0.5): beams at it from anywhere must stop there.
  const std::vector<Solid> solids{Rectangle(2.0, -1.0, 2.1, 0.5), Rectangle(2.0, 0.5, 2.1, 2.0)};
  for (int i = 0; i < 1000; ++i) {
    const double y = -0.9 + 0.0017 * i;
    const double angle = std::atan2(0.5 - y, 2.0);
    const World world = WorldOf(solids, {RobotAt(0.0, y, angle)});
    EXPECT_NEAR(FanCaster(FanOf(1, 0.0, 0.0, 0.0), world).Cast(world, 0)[0], std::hypot(2.0, 0.5 - y), 1e-6);
  }
}

TEST(FanCaster, SeesTheEndOfAWallThatItLooksAlong) {
  const World world = WorldOf({Rectangle(1.0, 0.0, 3.0, 0.2)}, {RobotAt(0.0, 0.0, 0.0)});
  EXPECT_NEAR(FanCaster(FanOf(1, 0.0, 0.0, 0.0), world).Cast(world, 0)[0], 1.0, 1e-9);
}

TEST(FanCaster, LooksAllRound) {
  const World world = WorldOf({Rectangle(-2.2, -9.0, -2.0, 9.0)}, {RobotAt(0.0, 0.0, 0.0)});
  const std::vector<double> ranges_m = FanCaster(FanOf(5, -kPi, kPi, 0.0), world).Cast(world, 0);
  EXPECT_NEAR(ranges_m[0], 2.0, 1e-9);
  EXPECT_NEAR(ranges_m[4], 2.0, 1e-9);
  EXPECT_EQ(ranges_m[2], kInfinity);
}

TEST(FanCaster, MayCountItsBeamsClockwise) {
  const World world =
      WorldOf({Rectangle(2.0, 0.5, 2.2, 3.0), Rectangle(-3.0, -1.2, 3.0, -1.0)}, {RobotAt(0.0, 0.0, 0.3)});
  std::vector<double> ranges_m = FanCaster(FanOf(91, -2.0, 2.0, 0.1), world).Cast(world, 0);
  const std::vector<double> clockwise = FanCaster(FanOf(91, 2.0, -2.0, 0.1), world).Cast(world, 0);
  std::reverse(ranges_m.begin(), ranges_m.end());
  for (std::size_t beam = 0; beam < 91; ++beam) {
    if (std::isinf(ranges_m[beam])) {
      EXPECT_EQ(clockwise[beam], kInfinity);
    } else {
      EXPECT_NEAR(clockwise[beam], ranges_m[beam], 1e-9);
    }
  }
}

// The range of one ray by asking all that could be in its way.
double RangeOf(const World& world, int robot, const base::Point& origin, double angle, double range_max_m) {
  const base::Point direction{std::cos(angle), std::sin(angle)};
  double range = kInfinity;
  for (const Solid& solid : world.solids()) {
    for (std::size_t i = 0; i < solid.outline.size(); ++i) {
      const base::Point &a = solid.outline[i], &b = solid.outline[(i + 1) % solid.outline.size()];
      const double ax = a.x - origin.x, ay = a.y - origin.y, dx = b.x - a.x, dy = b.y - a.y;
      const double sine = direction.x * dy - direction.y * dx;
      const double along = (ax * dy - ay * dx) / sine, on_side = (ax * direction.y - ay * direction.x) / sine;
      if (along >= 0.0 && on_side >= 0.0 && on_side <= 1.0) range = std::min(range, along);
    }
  }
  for (std::size_t other = 0; other < world.robots().size(); ++other) {
    if (static_cast<int>(other) == robot) continue;
    const double cx = world.poses()[other].x - origin.x, cy = world.poses()[other].y - origin.y;
    const double along = cx * direction.x + cy * direction.y, across = cx * direction.y - cy * direction.x;
    const double radius_m = world.robots()[other].radius_m;
    if (along > 0.0 && std::abs(across) <= radius_m) {
      range = std::min(range, along - std::sqrt(radius_m * radius_m - across * across));
    }
  }
  return range > range_max_m ? kInfinity : range;
}

TEST(FanCaster, EachBeamIsAnExactRayAmongWallsAndAHundredRobots) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Solid> solids;
  for (int column = 0; column < 6; ++column) {
    for (int row = 0; row < 4; ++row) {  // turned boxes on a lattice, robots between them
      const base::Point center{4.0 * column, 4.0 * row};
      const double angle = 2.0 * kPi * unit(random), length = 0.3 + unit(random), width = 0.1 + 0.3 * unit(random);
      Polygon corners;
      for (const auto& [u, v] : {base::Point{-1, -1}, base::Point{1, -1}, base::Point{1, 1}, base::Point{-1, 1}}) {
        corners.push_back({center.x + u * length * std::cos(angle) - v * width * std::sin(angle),
                           center.y + u * length * std::sin(angle) + v * width * std::cos(angle)});
      }
      solids.push_back({corners, {corners}});
    }
  }
  std::vector<Robot> robots;
  for (int i = 0; i < 100; ++i) {
    const double x = 4.0 * (i % 5) + 1.7 + 0.6 * (i / 5 % 2), y = 1.2 * (i / 10);  // between the columns of boxes
    robots.push_back(RobotAt(x, y, 6.3 * unit(random)));
  }
  const World world = WorldOf(solids, robots);
  int differing = 0, returned = 0;
  const Fan fans[] = {
      FanOf(181, -0.5 * kPi, 0.5 * kPi, 0.1),
      FanOf(360, -kPi, kPi, 0.1),  // the last beam is the first one again
      FanOf(181, 2.5, -1.0, 0.1),  // clockwise
      FanOf(181, -6.0, 6.0, 0.1),  // nearly two turns
      FanOf(1081, -2.3562, 2.3562, 0.1),
      FanOf(2, 0.0, kPi, 0.1),
      FanOf(1, 0.7, 0.7, 0.1),
  };
  for (const Fan& fan : fans) {
    const FanCaster caster(fan, world);
    for (int robot = 0; robot < 100; ++robot) {
      const base::Pose& pose = world.poses()[robot];
      const base::Point origin{pose.x + 0.1 * std::cos(pose.yaw), pose.y + 0.1 * std::sin(pose.yaw)};
      const std::vector<double> ranges_m = caster.Cast(world, robot);
      for (int beam = 0; beam < fan.beams; ++beam) {
        const double share = static_cast<double>(beam) / std::max(fan.beams - 1, 1);
        const double angle = fan.angle_min_rad + share * (fan.angle_max_rad - fan.angle_min_rad);
        const double exact = RangeOf(world, robot, origin, pose.yaw + angle, 5.0);
        differing += !(ranges_m[beam] == exact || std::abs(ranges_m[beam] - exact) <= 1e-9);
        returned += ranges_m[beam] < 5.0;
      }
    }
  }
  EXPECT_EQ(differing, 0);
  EXPECT_GT(returned, 10000);
}

TEST(FanCaster, InsideAnotherRobotMeasuresZero) {
  const World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0), RobotAt(0.4, 0.0, 0.0)});
  EXPECT_EQ(FanCaster(FanOf(1, 0.0, 0.0, 0.3), world).Cast(world, 0)[0], 0.0);
}

TEST(FanCaster, InsideAWallMeasuresZero) {
  const World world = WorldOf({Rectangle(2.0, -1.0, 2.2, 1.0)}, {RobotAt(1.8, 0.0, 0.0), RobotAt(2.4, 0.5, 0.0)});
  for (const double forward_m : {0.2 + 1e-6, 0.3}) {
    for (const double range : FanCaster(FanOf(5, -kPi, kPi, forward_m), world).Cast(world, 0)) EXPECT_EQ(range, 0.0);
  }
  EXPECT_EQ(FanCaster(FanOf(1, 0.0, 0.0, -0.3), world).Cast(world, 1)[0], 0.0);
  EXPECT_NEAR(FanCaster(FanOf(1, 0.0, 0.0, 0.2 - 1e-6), world).Cast(world, 0)[0], 1e-6, 1e-12);
  EXPECT_EQ(FanCaster(FanOf(1, 0.0, 0.0, 0.2), world).Cast(world, 1)[0], kInfinity);
}

TEST(FanCaster, RefusesImpossibleFans) {
  const World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0)});
  EXPECT_THROW(FanCaster(FanOf(0, 0.0, 1.0, 0.0), world), std::invalid_argument);
  EXPECT_THROW(FanCaster(FanOf(1, kInfinity, 1.0, 0.0), world), std::invalid_argument);
  Fan blind = FanOf(1, 0.0, 1.0, 0.0);
  blind.range_max_m = 0.0;
  EXPECT_THROW(FanCaster(blind, world), std::invalid_argument);
}

TEST(FanCaster, WritesOneRowPerRobot) {
  const World world = WorldOf({Rectangle(3.0, -10.0, 3.2, 10.0)}, {RobotAt(1.0, -3.0, 0.0), RobotAt(2.0, 3.0, 0.0)});
  const FanCaster caster(FanOf(3, -0.5, 0.5, 0.0), world);
  std::vector<double> ranges_m(6);
  caster.Cast(world, {1, 0}, {ranges_m.data(), 2, 3});
  EXPECT_NEAR(ranges_m[1], 1.0, 1e-12);
  EXPECT_NEAR(ranges_m[4], 2.0, 1e-12);
  EXPECT_THROW(caster.Cast(world, {0}, {ranges_m.data(), 2, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::world
