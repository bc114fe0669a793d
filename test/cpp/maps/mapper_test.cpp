#include "robotteamsim/maps/mapper.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rooms.hpp"

namespace robotteamsim::maps {
namespace {

const MapperParameters kParameters{0.05, 0.2, 0.1, 181, 0.3, 0.07, 0.02, 0.03, 6.0, 0.4};

/// A corridor 2 m wide around a block of 6 m x 6 m, with a pillar on each side.
Walls Ring() {
  Walls walls = Rectangle(0.0, 0.0, 10.0, 10.0);
  for (const Walls& more :
       {Rectangle(2.0, 2.0, 8.0, 8.0), Rectangle(4.0, 0.0, 4.4, 0.5), Rectangle(9.3, 3.0, 10.0, 3.4),
        Rectangle(6.0, 9.6, 6.4, 10.0), Rectangle(0.0, 7.0, 0.5, 7.4)}) {
    walls.insert(walls.end(), more.begin(), more.end());
  }
  return walls;
}

/// The poses of a robot that drives around the block by 0.05 m a step, and turns by 0.05 rad a step.
std::vector<base::Pose> Laps(int laps) {
  const double right_angle = std::acos(0.0);
  std::vector<base::Pose> poses{{1.0, 1.0, 0.0}};
  for (int side = 0; side < 4 * laps; ++side) {
    for (int i = 0; i < 160; ++i) poses.push_back(base::Composed(poses.back(), {0.05, 0.0, 0.0}));
    for (int i = 0; i < 31; ++i) poses.push_back(base::Composed(poses.back(), {0.0, 0.0, right_angle / 31.0}));
  }
  return poses;
}

/// Adds a motion to an odometry that measures distances and turns 1 % too large.
void Move(const base::Pose& motion, OdometryReading* odometry) {
  odometry->pose = base::Composed(odometry->pose, {1.01 * motion.x, 1.01 * motion.y, 1.01 * motion.yaw});
  odometry->covariance.xx += 1e-6;
  odometry->covariance.yy += 1e-6;
  odometry->covariance.yaw_yaw += 1e-6 + 1e-3 * motion.yaw * motion.yaw;
}

Mapper Driven(const std::vector<base::Pose>& poses, const Walls& walls) {
  const world::Fan fan = RoundFan(12.0);
  Mapper mapper(fan, 0.0, kParameters, poses.front());
  OdometryReading odometry;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) Move(base::RelativePose(poses[i - 1], poses[i]), &odometry);
    mapper.Step(odometry, Ranges(fan, walls, poses[i]), {});
  }
  return mapper;
}

double DistanceBetween(const base::Pose& a, const base::Pose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(Mapper, CorrectsTheOdometryAndMapsTheWalls) {
  const std::vector<base::Pose> poses = Laps(1);
  const Walls walls = Ring();
  const Mapper mapper = Driven(poses, walls);
  EXPECT_LT(DistanceBetween(mapper.pose(), poses.back()), 0.03);
  EXPECT_NEAR(base::NormaliseAngle(mapper.pose().yaw - poses.back().yaw), 0.0, 0.01);
  EXPECT_FALSE(mapper.is_lost());
  EXPECT_GT(mapper.submaps().size(), 2U);
  for (const HitCell& cell : mapper.map().Hits()) {
    const base::Point& hit = cell.mean.at;
    double nearest = 1e9;
    for (const auto& [a, b] : walls) {  // along the axes
      const double x = std::clamp(hit.x, std::min(a.x, b.x), std::max(a.x, b.x));
      const double y = std::clamp(hit.y, std::min(a.y, b.y), std::max(a.y, b.y));
      nearest = std::min(nearest, std::hypot(hit.x - x, hit.y - y));
    }
    EXPECT_LT(nearest, 0.1);
  }
}

TEST(Mapper, KeepsNoSubmapsOfKnownPlaces) {
  const Mapper once = Driven(Laps(1), Ring()), thrice = Driven(Laps(3), Ring());
  EXPECT_LE(thrice.submaps().size(), once.submaps().size() + 1);
}

TEST(Mapper, HasTheSameBitsEachTime) {
  const Mapper a = Driven(Laps(1), Ring()), b = Driven(Laps(1), Ring());
  EXPECT_EQ(a.pose().x, b.pose().x);
  EXPECT_EQ(a.pose().yaw, b.pose().yaw);
  EXPECT_EQ(a.map().Occupancy().cells, b.map().Occupancy().cells);
}

TEST(Mapper, WhoseLaserSeesNothingFollowsTheOdometryWithGrowingUncertainty) {
  const std::vector<base::Pose> poses = Laps(1);
  const Mapper mapper = Driven(poses, {});
  EXPECT_GT(DistanceBetween(mapper.pose(), poses.back()), 0.1);
  EXPECT_GT(mapper.covariance()(0, 0), 1e-3);
  EXPECT_TRUE(mapper.map().Hits().empty());
}

TEST(Mapper, OfARobotThatIsShutInMapsItsCell) {
  std::vector<base::Pose> turning;
  for (int i = 0; i < 100; ++i) turning.push_back({0.0, 0.0, base::NormaliseAngle(0.1 * i)});
  const Mapper mapper = Driven(turning, Rectangle(-0.5, -0.4, 0.5, 0.4));
  EXPECT_LT(DistanceBetween(mapper.pose(), turning.back()), 0.01);
  EXPECT_FALSE(mapper.is_lost());
}

TEST(Mapper, OfARobotThatWasCarriedElsewhereIsLostAndLeavesTheMapAlone) {
  const Walls ring = Ring();
  const world::Fan fan = RoundFan(12.0);
  const std::vector<base::Pose> poses = Laps(1);
  Mapper mapper(fan, 0.0, kParameters, poses.front());
  OdometryReading odometry;
  base::Pose before = poses.front();
  const auto step = [&](const base::Pose& truth, const base::Pose& motion) {
    Move(motion, &odometry);
    mapper.Step(odometry, Ranges(fan, ring, truth), {});
    before = truth;
  };
  for (const base::Pose& pose : poses) step(pose, base::RelativePose(before, pose));
  const std::size_t hits = mapper.map().Hits().size();
  base::Pose truth{9.0, 4.0, 2.0};
  for (int i = 0; i < 60; ++i) step(truth = base::Composed(truth, {0.05, 0.0, 0.0}), {0.05, 0.0, 0.0});
  EXPECT_TRUE(mapper.is_lost());
  EXPECT_LT(mapper.map().Hits().size(), hits + hits / 10);
}

TEST(Mapper, RefusesWhatIsNoReading) {
  const world::Fan fan = RoundFan(5.0, 3);
  Mapper mapper(fan, 0.0, kParameters, {});
  OdometryReading wrong;
  wrong.covariance.xy = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(mapper.Step({}, {1.0F}, {}), std::invalid_argument);
  EXPECT_THROW(mapper.Step(wrong, {1.0F, 1.0F, 1.0F}, {}), std::invalid_argument);
  EXPECT_THROW(Mapper(fan, -1.0, kParameters, {}), std::invalid_argument);
  MapperParameters none = kParameters;
  none.update_m = 0.0;
  EXPECT_THROW(Mapper(fan, 0.0, none, {}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
