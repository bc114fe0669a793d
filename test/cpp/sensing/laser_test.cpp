#include "robotteamsim/sensing/laser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robotteamsim::sensing {
namespace {

const double kPi = std::acos(-1.0);
const double kInfinity = std::numeric_limits<double>::infinity();

LaserModel Model(int beams, double angle_min, double angle_max, double forward) {
  return {beams, angle_min, angle_max, forward, 0.05, 5.0, 0.05, 5.0};
}

world::Solid Rectangle(double x0, double y0, double x1, double y1) {
  const world::Polygon corners{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  return {corners, {corners}};
}

world::Robot RobotAt(double x, double y, double yaw) {
  world::Robot robot;
  robot.start = {x, y, yaw};
  return robot;
}

world::World WorldOf(const std::vector<world::Solid>& solids, const std::vector<world::Robot>& robots,
                     const std::vector<world::Door>& doors = {}) {
  return world::World(solids, doors, robots, 0.1, 5);
}

TEST(Laser, MeasuresAWallAheadByDistanceOverCosine) {
  const world::World world = WorldOf({Rectangle(3.0, -10.0, 3.2, 10.0)}, {RobotAt(1.0, 0.0, 0.0)});
  const std::vector<double> ranges = Laser(Model(181, -kPi / 2.0, kPi / 2.0, 0.0), world).Scan(world, 0);
  ASSERT_EQ(ranges.size(), 181U);
  EXPECT_NEAR(ranges[90], 2.0, 1e-12);
  EXPECT_NEAR(ranges[90 + 60], 4.0, 1e-12);
  EXPECT_NEAR(ranges[90 - 60], 4.0, 1e-12);
  EXPECT_NEAR(ranges[90 + 66], 2.0 / std::cos(66.0 * kPi / 180.0), 1e-12);
  EXPECT_EQ(ranges[90 + 67], kInfinity);  // 5.12 m
  EXPECT_EQ(ranges[180], kInfinity);      // along the wall
}

TEST(Laser, StandsForwardOfTheRobotAndTurnsWithIt) {
  const world::World world = WorldOf({Rectangle(-1.0, 3.0, 1.0, 3.2)}, {RobotAt(0.0, 0.0, kPi / 2.0)});
  const Laser laser(Model(1, 0.0, 0.0, 0.1), world);
  EXPECT_NEAR(laser.Scan(world, 0)[0], 2.9, 1e-12);
}

TEST(Laser, SeesOtherRobotsAsDiscsAndNotItsOwn) {
  const world::World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0), RobotAt(2.0, 0.0, 0.0)});
  const Laser laser(Model(3, -0.05, 0.05, 0.1), world);
  const std::vector<double> ranges = laser.Scan(world, 0);
  EXPECT_NEAR(ranges[1], 1.7, 1e-12);
  const double along = 1.9 * std::cos(0.05), across = 1.9 * std::sin(0.05);
  EXPECT_NEAR(ranges[2], along - std::sqrt(0.04 - across * across), 1e-12);
  EXPECT_EQ(laser.Scan(world, 1)[1], kInfinity);
}

TEST(Laser, SeesTheSidesOfRobotsWithCorners) {
  world::Robot box = RobotAt(2.0, 0.0, kPi / 2.0);
  box.footprint = {{-0.5, -0.1}, {0.5, -0.1}, {0.5, 0.3}, {-0.5, 0.3}};  // turned: 0.3 to the left is towards us
  const world::World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0), box});
  const Laser laser(Model(3, -0.2, 0.2, 0.0), world);
  const std::vector<double> ranges = laser.Scan(world, 0);
  EXPECT_NEAR(ranges[1], 1.7, 1e-12);
  EXPECT_NEAR(ranges[0], 1.7 / std::cos(0.2), 1e-12);
  EXPECT_EQ(laser.Scan(world, 1)[1], kInfinity);
}

TEST(Laser, SeesTheNearestOfAll) {
  const world::World world = WorldOf({Rectangle(4.0, -1.0, 4.2, 1.0), Rectangle(1.0, -0.1, 1.2, 0.1)},
                                     {RobotAt(0.0, 0.0, 0.0), RobotAt(2.0, 0.0, 0.0)});
  EXPECT_NEAR(Laser(Model(1, 0.0, 0.0, 0.0), world).Scan(world, 0)[0], 1.0, 1e-12);
}

TEST(Laser, SeesClosedDoorsOnly) {
  world::World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0)}, {{Rectangle(2.0, -1.0, 2.06, 1.0), false}});
  const Laser laser(Model(1, 0.0, 0.0, 0.0), world);
  EXPECT_EQ(laser.Scan(world, 0)[0], kInfinity);
  world.SetDoorClosed(0, true);
  EXPECT_NEAR(laser.Scan(world, 0)[0], 2.0, 1e-12);
}

TEST(Laser, LetsNoBeamThroughACornerWhereWallsMeet) {
  // Two walls that share the edge (2, 0.5): beams at it from anywhere must stop there.
  const std::vector<world::Solid> solids{Rectangle(2.0, -1.0, 2.1, 0.5), Rectangle(2.0, 0.5, 2.1, 2.0)};
  for (int i = 0; i < 1000; ++i) {
    const double y = -0.9 + 0.0017 * i;
    const double angle = std::atan2(0.5 - y, 2.0);
    const world::World world = WorldOf(solids, {RobotAt(0.0, y, angle)});
    EXPECT_NEAR(Laser(Model(1, 0.0, 0.0, 0.0), world).Scan(world, 0)[0], std::hypot(2.0, 0.5 - y), 1e-6);
  }
}

TEST(Laser, SeesTheEndOfAWallThatItLooksAlong) {
  const world::World world = WorldOf({Rectangle(1.0, 0.0, 3.0, 0.2)}, {RobotAt(0.0, 0.0, 0.0)});
  EXPECT_NEAR(Laser(Model(1, 0.0, 0.0, 0.0), world).Scan(world, 0)[0], 1.0, 1e-9);
}

TEST(Laser, LooksAllRound) {
  const world::World world = WorldOf({Rectangle(-2.2, -9.0, -2.0, 9.0)}, {RobotAt(0.0, 0.0, 0.0)});
  const std::vector<double> ranges = Laser(Model(5, -kPi, kPi, 0.0), world).Scan(world, 0);
  EXPECT_NEAR(ranges[0], 2.0, 1e-9);
  EXPECT_NEAR(ranges[4], 2.0, 1e-9);
  EXPECT_EQ(ranges[2], kInfinity);
}

TEST(Laser, MayCountItsBeamsClockwise) {
  const world::World world =
      WorldOf({Rectangle(2.0, 0.5, 2.2, 3.0), Rectangle(-3.0, -1.2, 3.0, -1.0)}, {RobotAt(0.0, 0.0, 0.3)});
  std::vector<double> ranges = Laser(Model(91, -2.0, 2.0, 0.1), world).Scan(world, 0);
  const std::vector<double> clockwise = Laser(Model(91, 2.0, -2.0, 0.1), world).Scan(world, 0);
  std::reverse(ranges.begin(), ranges.end());
  for (std::size_t beam = 0; beam < 91; ++beam) {
    if (std::isinf(ranges[beam])) {
      EXPECT_EQ(clockwise[beam], kInfinity);
    } else {
      EXPECT_NEAR(clockwise[beam], ranges[beam], 1e-9);
    }
  }
}

// The range of one ray by asking all that could be in its way.
double RangeOf(const world::World& world, int robot, const base::Point& origin, double angle, double range_max) {
  const base::Point direction{std::cos(angle), std::sin(angle)};
  double range = kInfinity;
  for (const world::Solid& solid : world.solids()) {
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
    const double radius = world.robots()[other].radius;
    if (along > 0.0 && std::abs(across) <= radius) {
      range = std::min(range, along - std::sqrt(radius * radius - across * across));
    }
  }
  return range > range_max ? kInfinity : range;
}

TEST(Laser, EachBeamIsAnExactRayAmongWallsAndAHundredRobots) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<world::Solid> solids;
  for (int column = 0; column < 6; ++column) {
    for (int row = 0; row < 4; ++row) {  // turned boxes on a lattice, robots between them
      const base::Point center{4.0 * column, 4.0 * row};
      const double angle = 2.0 * kPi * unit(random), length = 0.3 + unit(random), width = 0.1 + 0.3 * unit(random);
      world::Polygon corners;
      for (const auto& [u, v] : {base::Point{-1, -1}, base::Point{1, -1}, base::Point{1, 1}, base::Point{-1, 1}}) {
        corners.push_back({center.x + u * length * std::cos(angle) - v * width * std::sin(angle),
                           center.y + u * length * std::sin(angle) + v * width * std::cos(angle)});
      }
      solids.push_back({corners, {corners}});
    }
  }
  std::vector<world::Robot> robots;
  for (int i = 0; i < 100; ++i) {
    const double x = 4.0 * (i % 5) + 1.7 + 0.6 * (i / 5 % 2), y = 1.2 * (i / 10);  // between the columns of boxes
    robots.push_back(RobotAt(x, y, 6.3 * unit(random)));
  }
  const world::World world = WorldOf(solids, robots);
  int differing = 0, returned = 0;
  for (const auto& [low, high] : {std::pair{-0.5 * kPi, 0.5 * kPi}, std::pair{-kPi, kPi}, std::pair{2.5, -1.0}}) {
    const Laser laser(Model(181, low, high, 0.1), world);
    for (int robot = 0; robot < 100; ++robot) {
      const base::Pose& pose = world.poses()[robot];
      const base::Point origin{pose.x + 0.1 * std::cos(pose.yaw), pose.y + 0.1 * std::sin(pose.yaw)};
      const std::vector<double> ranges = laser.Scan(world, robot);
      for (int beam = 0; beam < 181; ++beam) {
        const double exact = RangeOf(world, robot, origin, pose.yaw + low + beam * (high - low) / 180.0, 5.0);
        differing += !(ranges[beam] == exact || std::abs(ranges[beam] - exact) <= 1e-9);
        returned += ranges[beam] < 5.0;
      }
    }
  }
  EXPECT_EQ(differing, 0);
  EXPECT_GT(returned, 10000);
}

TEST(Laser, InsideAnotherRobotMeasuresZero) {
  const world::World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0), RobotAt(0.4, 0.0, 0.0)});
  EXPECT_EQ(Laser(Model(1, 0.0, 0.0, 0.3), world).Scan(world, 0)[0], 0.0);
}

TEST(Laser, InsideAWallMeasuresZero) {
  const world::World world =
      WorldOf({Rectangle(2.0, -1.0, 2.2, 1.0)}, {RobotAt(1.8, 0.0, 0.0), RobotAt(2.4, 0.5, 0.0)});
  for (const double forward : {0.2 + 1e-6, 0.3}) {
    for (const double range : Laser(Model(5, -kPi, kPi, forward), world).Scan(world, 0)) EXPECT_EQ(range, 0.0);
  }
  EXPECT_EQ(Laser(Model(1, 0.0, 0.0, -0.3), world).Scan(world, 1)[0], 0.0);
  EXPECT_NEAR(Laser(Model(1, 0.0, 0.0, 0.2 - 1e-6), world).Scan(world, 0)[0], 1e-6, 1e-12);
  EXPECT_EQ(Laser(Model(1, 0.0, 0.0, 0.2), world).Scan(world, 1)[0], kInfinity);
}

std::vector<float> Reported(const LaserModel& model, const std::vector<double>& noise = {}) {
  const world::World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0)});
  const std::vector<double> ranges{0.01, 0.05, 5.0, kInfinity};
  std::vector<float> report(ranges.size());
  Laser(model, world).Report(ranges, noise.empty() ? nullptr : noise.data(), report.data());
  return report;
}

TEST(Laser, ReportsWhatItCannotMeasureAsItsModelSays) {
  LaserModel model = Model(4, 0.0, 1.0, 0.0);
  EXPECT_EQ(Reported(model), (std::vector<float>{0.05F, 0.05F, 5.0F, 5.0F}));
  model.too_near = -kInfinity;
  model.no_return = kInfinity;
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(Reported(model), (std::vector<float>{-infinity, 0.05F, 5.0F, infinity}));
  EXPECT_EQ(Reported(model, {0.5, -0.01, 0.1, -9.0}), (std::vector<float>{0.51F, -infinity, infinity, infinity}));
}

TEST(Laser, RefusesImpossibleModels) {
  const world::World world = WorldOf({}, {RobotAt(0.0, 0.0, 0.0)});
  EXPECT_THROW(Laser(Model(0, 0.0, 1.0, 0.0), world), std::invalid_argument);
  EXPECT_THROW(Laser(Model(1, kInfinity, 1.0, 0.0), world), std::invalid_argument);
  LaserModel blind = Model(1, 0.0, 1.0, 0.0);
  blind.range_max = blind.range_min;
  EXPECT_THROW(Laser(blind, world), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::sensing
