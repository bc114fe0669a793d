#include "robotteamsim/plan/grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace robotteamsim::plan {
namespace {

/// A grid of 1 m cells from lines of text, the top line being the highest row; '#' is occupied.
PlanningGrid Drawn(const std::vector<std::string>& lines, double inflation_m = 0.0) {
  GridShape shape{{0.0, 0.0}, 1.0, static_cast<int>(lines.size()), static_cast<int>(lines[0].size())};
  std::vector<std::uint8_t> occupied;
  for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
    for (const char cell : *line) occupied.push_back(cell == '#');
  }
  return PlanningGrid(shape, occupied, inflation_m);
}

const std::vector<std::string> kWallWithGap = {
    ".....",  //
    "..#..",  //
    "..#..",  //
    "..#..",  //
};

TEST(PlanningGrid, RefusesCellsThatDoNotFillTheShape) {
  EXPECT_THROW(PlanningGrid({{0.0, 0.0}, 0.1, 2, 2}, {0, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(PlanningGrid({{0.0, 0.0}, 0.0, 1, 1}, {0}, 0.0), std::invalid_argument);
  EXPECT_THROW(PlanningGrid({{0.0, 0.0}, 0.1, 1, 1}, {0}, -0.1), std::invalid_argument);
}

TEST(PlanningGrid, InflationBlocksCellsWhoseCentreIsTooNearToAnObstacle) {
  const std::vector<std::string> one_obstacle = {".....", ".....", "..#..", ".....", "....."};
  // The neighbour's centre is 0.5 m from the obstacle's border, the next 1.5 m, the diagonal one 0.71 m.
  const PlanningGrid near = Drawn(one_obstacle, 0.6);
  EXPECT_FALSE(near.IsFree({1.5, 2.5}));
  EXPECT_TRUE(near.IsFree({1.5, 1.5}));
  const PlanningGrid wide = Drawn(one_obstacle, 0.8);
  EXPECT_FALSE(wide.IsFree({1.5, 1.5}));
  EXPECT_TRUE(wide.IsFree({0.5, 2.5}));
  EXPECT_TRUE(Drawn(one_obstacle, 0.5).IsFree({1.5, 2.5}));
}

TEST(PlanningGrid, NothingIsFreeBeyondTheGrid) {
  const PlanningGrid grid = Drawn({"..", ".."});
  EXPECT_TRUE(grid.IsFree({0.1, 1.9}));
  EXPECT_FALSE(grid.IsFree({-0.1, 1.0}));
  EXPECT_FALSE(grid.IsFree({1.0, 2.1}));
  EXPECT_FALSE(grid.IsFree({1e300, std::nan("")}));
}

TEST(PlanningGrid, NearestFreeIsThePointItselfWhereItIsFree) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  const base::Point itself = *grid.NearestFree({1.2, 0.3}, 1.0);
  EXPECT_EQ(itself.x, 1.2);
  EXPECT_EQ(itself.y, 0.3);
  const base::Point beside = *grid.NearestFree({2.6, 1.4}, 2.0);
  EXPECT_EQ(beside.x, 3.5);
  EXPECT_EQ(beside.y, 1.5);
  EXPECT_FALSE(grid.NearestFree({2.5, 0.5}, 0.5).has_value());
}

TEST(PlanningGrid, WallsBlockTheLineOfSight) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  EXPECT_FALSE(grid.IsLineFree({0.5, 0.5}, {4.5, 0.5}));
  EXPECT_TRUE(grid.IsLineFree({0.5, 3.5}, {4.5, 3.2}));
  EXPECT_TRUE(grid.IsLineFree({0.5, 0.5}, {1.9, 3.9}));
  EXPECT_FALSE(grid.IsLineFree({0.5, 0.5}, {2.5, 0.5}));
}

TEST(PlanningGrid, LineThroughTheCornerOfAnObstacleIsNotFree) {
  const PlanningGrid grid = Drawn({"#.", ".."});
  EXPECT_FALSE(grid.IsLineFree({0.5, 0.5}, {1.5, 1.5}));
  EXPECT_TRUE(Drawn({"..", ".."}).IsLineFree({0.5, 0.5}, {1.5, 1.5}));
}

TEST(PlanningGrid, DistanceFieldGoesAroundTheWall) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  const std::vector<float> field = grid.DistanceMap({4.5, 0.5});
  EXPECT_EQ(field[4], 0.0F);
  EXPECT_EQ(field[3], 1.0F);
  EXPECT_TRUE(std::isinf(field[2]));
  // Up the right side to the gap (one diagonal, two straight), across (two), down the left (two, one diagonal): the
  // diagonals beside the wall's top would cut its corner.
  EXPECT_FLOAT_EQ(field[0], static_cast<float>(6.0 + 2.0 * std::sqrt(2.0)));
  EXPECT_EQ(grid.ValueAt(field.data(), field.size(), {3.1, 0.9}), 1.0);
  EXPECT_TRUE(std::isinf(grid.ValueAt(field.data(), field.size(), {-1.0, 0.0})));
}

TEST(PlanningGrid, DistanceFieldRefusesABlockedGoal) {
  EXPECT_THROW(Drawn(kWallWithGap).DistanceMap({2.5, 0.5}), std::invalid_argument);
}

TEST(PlanningGrid, ShortestPathHasTheLengthOfTheField) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  const std::vector<base::Point> path = grid.ShortestPath({0.5, 0.5}, {4.5, 0.5}, 100.0);
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    length += std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y);
  }
  EXPECT_NEAR(length, grid.DistanceMap({4.5, 0.5})[0], 1e-6);
  EXPECT_TRUE(grid.ShortestPath({0.5, 0.5}, {4.5, 0.5}, 8.5).empty());
  EXPECT_TRUE(grid.ShortestPath({0.5, 0.5}, {2.5, 0.5}, 100.0).empty());
  EXPECT_EQ(grid.ShortestPath({0.5, 0.5}, {0.6, 0.6}, 100.0).size(), 1U);
}

TEST(PlanningGrid, NoPathLeadsBetweenTwoRooms) {
  EXPECT_TRUE(Drawn({".#.", ".#."}).ShortestPath({0.5, 0.5}, {2.5, 0.5}, 1e9).empty());
}

TEST(PlanningGrid, ShortcutKeepsOnlyTheCorners) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  const std::vector<base::Point> corners = grid.Shortcut(grid.ShortestPath({0.5, 0.5}, {4.5, 0.5}, 100.0));
  ASSERT_EQ(corners.size(), 4U);
  EXPECT_EQ(corners[1].y, 3.5);
  EXPECT_EQ(corners[2].y, 3.5);
  EXPECT_EQ(grid.Shortcut(grid.ShortestPath({0.5, 0.5}, {1.5, 3.5}, 100.0)).size(), 2U);
}

TEST(PlanningGrid, WaypointsAreTheEndsAndCornersOfAPath) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  const std::vector<base::Point> points = grid.Waypoints({0.5, 0.5}, {4.5, 0.5}, 100.0);
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points[0].x, 0.5);
  EXPECT_EQ(points[1].y, 3.5);
  EXPECT_EQ(points[3].x, 4.5);
  EXPECT_TRUE(grid.Waypoints({0.5, 0.5}, {4.5, 0.5}, 8.5).empty());
}

TEST(PlanningGrid, ReachableCellsEndAtAWallInsideTheDisc) {
  const PlanningGrid grid = Drawn(kWallWithGap);
  const std::vector<float> field = grid.DistanceMap({4.5, 0.5});
  // Across the wall there are nearer cells within 3 m, but the disc holds no way to them.
  const base::Point least = grid.LeastReachable(field.data(), field.size(), {1.5, 0.5}, 2.5)->place;
  EXPECT_EQ(least.x, 1.5);
  EXPECT_EQ(least.y, 2.5);
  const base::Point nearest = *grid.NearestReachable({1.5, 0.5}, {4.5, 0.5}, 2.5);
  EXPECT_EQ(nearest.x, 1.5);
  EXPECT_EQ(nearest.y, 0.5);
  const base::Point across = *grid.NearestInDisc({1.5, 0.5}, {4.5, 0.5}, 2.5);
  EXPECT_EQ(across.x, 3.5);
  EXPECT_EQ(across.y, 0.5);
  EXPECT_FALSE(grid.NearestReachable({2.5, 0.5}, {4.5, 0.5}, 2.5).has_value());
}

}  // namespace
}  // namespace robotteamsim::plan
