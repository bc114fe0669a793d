#include "robotteamsim/sensing/team_sensors.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robotteamsim::sensing {
namespace {

constexpr int kBeams = 3;

/// Two robots before a wall at x = 3 m: 2 m and 1 m from it.
world::World TwoRobots() {
  const world::Polygon wall{{3.0, -10.0}, {3.2, -10.0}, {3.2, 10.0}, {3.0, 10.0}};
  world::Robot far, near;
  far.start = {1.0, -3.0, 0.0};
  near.start = {2.0, 3.0, 0.0};
  return world::World({{wall, {wall}}}, {}, {far, near}, 0.1, 5);
}

std::shared_ptr<const Laser> LaserOf(const world::World& world) {
  return std::make_shared<const Laser>(LaserModel{kBeams, -0.5, 0.5, 0.0, 0.05, 5.0, 0.05, 5.0}, world);
}

std::shared_ptr<TeamOdometry> Odometries(const OdometryModel& model = {}) {
  return std::make_shared<TeamOdometry>(std::vector<OdometryModel>(2, model), 0.1, std::vector<bool>(2, false));
}

TEST(ScanTeam, HasOneRowPerRobotAndAddsTheNoiseOfEachBeam) {
  const world::World world = TwoRobots();
  const std::vector<double> noise{0.0, 0.1, 0.0, 0.0, 0.2, 0.0};
  std::vector<float> ranges(2 * kBeams);
  ScanTeam(*LaserOf(world), world, {1, 0}, {noise.data(), 2, kBeams}, {ranges.data(), 2, kBeams});
  EXPECT_NEAR(ranges[1], 1.1F, 1e-6F);
  EXPECT_NEAR(ranges[kBeams + 1], 2.2F, 1e-6F);
  ScanTeam(*LaserOf(world), world, {1, 0}, {}, {ranges.data(), 2, kBeams});
  EXPECT_NEAR(ranges[1], 1.0F, 1e-6F);
}

TEST(ScanTeam, RefusesTablesOfAnotherShape) {
  const world::World world = TwoRobots();
  const std::vector<double> noise(2 * kBeams);
  std::vector<float> ranges(2 * kBeams);
  const base::Table<float> rows{ranges.data(), 2, kBeams};
  EXPECT_THROW(ScanTeam(*LaserOf(world), world, {0}, {}, rows), std::invalid_argument);
  EXPECT_THROW(ScanTeam(*LaserOf(world), world, {0, 1}, {noise.data(), kBeams, 2}, rows), std::invalid_argument);
}

TEST(ScanNearest, IsTheShortestRangeWithNoise) {
  const world::World world = TwoRobots();
  const std::vector<float> nearest = ScanNearest(*LaserOf(world), world, {0, 1}, {});
  ASSERT_EQ(nearest.size(), 2U);
  EXPECT_NEAR(nearest[0], 2.0F, 1e-6F);
  EXPECT_NEAR(nearest[1], 1.0F, 1e-6F);
  EXPECT_NEAR(ScanNearest(*LaserOf(world), world, {0, 1}, {0.0, 0.25})[1], 1.25F, 1e-6F);
  EXPECT_THROW(ScanNearest(*LaserOf(world), world, {0, 1}, {0.1}), std::invalid_argument);
}

TEST(DimTeam, RemovesWhatSmokeHidesFromEachRobot) {
  const world::World world = TwoRobots();
  std::vector<float> ranges(2 * kBeams);
  const base::Table<float> rows{ranges.data(), 2, kBeams};
  ScanTeam(*LaserOf(world), world, {0, 1}, {}, rows);
  const hazards::Haze haze({{-10.0, -10.0}, 1.0, 20, 20}, std::vector<float>(20 * 20, 1.0F), 1.0, 1.5);
  DimTeam(*LaserOf(world), world, {0, 1}, haze, rows);
  EXPECT_EQ(ranges[1], 5.0F);  // 2 m away: beyond the sight of 1.5 m
  EXPECT_NEAR(ranges[kBeams + 1], 1.0F, 1e-6F);
  EXPECT_THROW(DimTeam(*LaserOf(world), world, {0}, haze, rows), std::invalid_argument);
}

TEST(TeamOdometry, FollowsAWorldByItsMotionsAndTwists) {
  world::World world = TwoRobots();
  const OdometryModel noisy{0.004, 0.001, 0.002, 0.003};
  const auto one = Odometries(noisy), other = Odometries(noisy), exact = Odometries();
  const std::vector<Odometry::Noise> noise{{0.1, 0.2, 0.3}, {-0.1, -0.2, 0.4}};
  for (int step = 0; step < 20; ++step) {
    world.Step({{0.7, 0.0, 0.5}, {0.7, 0.0, 0.0}});
    const std::vector<OdometryReading> followed = one->Follow(world, noise);
    const std::vector<OdometryReading> stepped = other->Step(world.motions(), world.twists(), noise);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(followed[i].pose.x, stepped[i].pose.x);
      ASSERT_EQ(followed[i].pose.qz, stepped[i].pose.qz);
      ASSERT_EQ(followed[i].twist.linear_x, stepped[i].twist.linear_x);
    }
    EXPECT_NE(followed[0].pose.x, exact->Follow(world, noise)[0].pose.x);
  }
}

TEST(TeamSensors, WriteNothingIfAShapeIsWrong) {
  world::World world = TwoRobots();
  const auto odometry = Odometries();
  TeamSensors sensors(odometry, {{LaserOf(world), {0, 1}}});
  const std::vector<Odometry::Noise> noise(2);
  std::vector<RobotReading> readings(2);
  std::vector<float> ranges(2 * kBeams);
  const base::Table<float> rows{ranges.data(), 2, kBeams}, cut{ranges.data(), 1, kBeams};
  world.Step({{0.7, 0.0, 0.0}, {}});
  EXPECT_THROW(sensors.Read(world, noise, {}, readings.data(), {}), std::invalid_argument);
  EXPECT_THROW(sensors.Read(world, noise, {}, readings.data(), {cut}), std::invalid_argument);
  EXPECT_THROW(sensors.Read(world, noise, {{}, {}}, readings.data(), {rows}), std::invalid_argument);
  const std::vector<double> of_one(kBeams);
  EXPECT_THROW(sensors.Read(world, noise, {{of_one.data(), 1, kBeams}}, readings.data(), {rows}),
               std::invalid_argument);
  EXPECT_EQ(readings[0].ground_truth.x, 0.0);
  sensors.Read(world, noise, {}, readings.data(), {rows});
  EXPECT_EQ(readings[0].ground_truth.x, world.poses()[0].x);
  EXPECT_NEAR(readings[0].odometry.pose.x, world.poses()[0].x - 1.0, 1e-12);  // of one step, not of four
  EXPECT_NEAR(ranges[1], 3.0 - world.poses()[0].x, 1e-6);
}

}  // namespace
}  // namespace robotteamsim::sensing
