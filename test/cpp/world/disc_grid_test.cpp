#include "robotteamsim/world/disc_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace robotteamsim::world {
namespace {

std::vector<int> Near(const DiscGrid& grid, const base::Point& point, double reach_m) {
  std::vector<int> robots;
  grid.ForEachNear(point, reach_m, [&](int robot, const base::Pose&) { robots.push_back(robot); });
  std::sort(robots.begin(), robots.end());
  return robots;
}

// Spreads robots over width x height, and checks everybody's neighbours within 2 m.
void ExpectNoneMissed(int count, double width, double height, double most_listed) {
  std::mt19937 random(count);
  std::uniform_real_distribution<double> x(-0.3 * width, 0.7 * width), y(-0.5 * height, 0.5 * height);
  std::vector<base::Pose> poses(count);
  for (base::Pose& pose : poses) pose = {x(random), y(random), 0.0};
  DiscGrid grid;
  grid.Rebuild(poses);
  double listed = 0.0;
  for (int i = 0; i < 200; ++i) {
    const base::Point point{1.2 * x(random), 1.2 * y(random)};
    const std::vector<int> near = Near(grid, point, 2.0);
    listed += static_cast<double>(near.size()) / count / 200.0;
    EXPECT_EQ(std::adjacent_find(near.begin(), near.end()), near.end());
    for (int robot = 0; robot < count; ++robot) {
      const bool is_near = std::hypot(poses[robot].x - point.x, poses[robot].y - point.y) <= 2.0;
      EXPECT_TRUE(!is_near || std::binary_search(near.begin(), near.end(), robot));
    }
  }
  EXPECT_LE(listed, most_listed + 1e-9);
}

TEST(DiscGrid, LeavesOutThoseWhoAreNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  DiscGrid grid;
  std::vector<int> found;
  const auto look = [&] {
    found.clear();
    grid.ForEachNear({1.0, 1.0}, 10.0, [&](int robot, const base::Pose&) { found.push_back(robot); });
    std::sort(found.begin(), found.end());
    return found;
  };
  grid.Rebuild({{nan, nan, nan}, {1.0, 1.0, 0.0}, {nan, nan, nan}, {2.0, 1.0, 0.0}});
  EXPECT_EQ(look(), (std::vector<int>{1, 3}));
  grid.Rebuild({{nan, nan, nan}});
  EXPECT_TRUE(look().empty());
}

TEST(DiscGrid, MissesNoRobotWithinReachAndLeavesFarOnesOut) {
  ExpectNoneMissed(1000, 60.0, 40.0, 0.05);
  ExpectNoneMissed(100, 60.0, 40.0, 0.1);
  ExpectNoneMissed(3, 60.0, 40.0, 1.0);
  ExpectNoneMissed(500, 5000.0, 0.0, 0.05);
  ExpectNoneMissed(500, 0.0, 5000.0, 0.05);
  ExpectNoneMissed(1000, 0.0, 0.0, 1.0);
}

TEST(DiscGrid, OfNobodyHasNobody) {
  DiscGrid grid;
  EXPECT_TRUE(Near(grid, {1.0, 2.0}, 3.0).empty());
  grid.Rebuild({});
  EXPECT_TRUE(Near(grid, {1.0, 2.0}, 3.0).empty());
}

TEST(DiscGrid, FollowsTheRobots) {
  DiscGrid grid;
  grid.Rebuild({{0.0, 0.0, 0.0}, {100.0, 0.0, 0.0}, {200.0, 0.0, 0.0}});
  grid.Rebuild({{0.0, 0.0, 0.0}, {300.0, 50.0, 0.0}, {600.0, 0.0, 0.0}});
  EXPECT_EQ(Near(grid, {300.0, 50.0}, 1.0), std::vector<int>{1});
}

}  // namespace
}  // namespace robotteamsim::world
