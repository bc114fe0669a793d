#include "robotteamsim/hazards/grid_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

namespace robotteamsim::hazards {
namespace {

// Cells of 0.5 m from (-1, 2) on: 2 rows, 3 columns.
const std::vector<float> kValues{1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 600.0F};
GridValues Values() { return {{{-1.0, 2.0}, 0.5, 2, 3}, kValues.data()}; }

/// Lines of sight over all cells, with or without a wall across x = -0.25 m up to y = 2.5 m.
plan::PlanningGrid Sight(bool with_wall = true) {
  std::vector<std::uint8_t> occupied(20 * 40, 0);
  for (int row = 0; row < 10 && with_wall; ++row) occupied[row * 40 + 17] = 1;
  return plan::PlanningGrid({{-2.0, 1.5}, 0.1, 20, 40}, occupied, 0.0);
}

TEST(ValuesAt, AreThoseOfTheCellsThatContainThePoints) {
  const double nan = std::nan("");
  const std::vector<base::Point> points{{-1.0, 2.0}, {-0.51, 2.49}, {0.49, 2.99}, {-1.01, 2.0}, {0.5, 2.1}, {nan, 2.1}};
  EXPECT_EQ(ValuesAt(Values(), points, -7.0), (std::vector<double>{1.0, 1.0, 600.0, -7.0, -7.0, -7.0}));
}

TEST(ValuesAt, RefuseAGridWithoutSizeAndValuesThatAreNotFinite) {
  GridValues values = Values();
  values.shape.resolution_m = 0.0;
  EXPECT_THROW(ValuesAt(values, {}, 0.0), std::invalid_argument);
  const float infinite = std::numeric_limits<float>::infinity();
  EXPECT_THROW(ValuesAt({{{0.0, 0.0}, 0.5, 1, 1}, &infinite}, {{0.1, 0.1}}, 0.0), std::invalid_argument);
  EXPECT_THROW(ValuesAt(Values(), {}, std::nan("")), std::invalid_argument);
}

TEST(HotInSight, IsWithinTheRange) {
  // The centres of the hot cells are (0.25, 2.75), 600 degrees, and (-0.25, 2.75), 5 degrees.
  const std::vector<base::Point> near = HotInSight(Values(), 5.0, Sight(), {-0.75, 2.75}, 0.6);
  ASSERT_EQ(near.size(), 1U);
  EXPECT_DOUBLE_EQ(near[0].x, -0.25);
  EXPECT_DOUBLE_EQ(near[0].y, 2.75);
  EXPECT_EQ(HotInSight(Values(), 5.0, Sight(), {-0.75, 2.75}, 1.0).size(), 2U);
  EXPECT_EQ(HotInSight(Values(), 600.0, Sight(), {-0.75, 2.75}, 1.0).size(), 1U);
  EXPECT_TRUE(HotInSight(Values(), 600.5, Sight(), {-0.75, 2.75}, 1.0).empty());
}

TEST(HotInSight, EndsAtWalls) {
  // The cells of 3, 4 and 5 degrees; the wall hides the first one.
  EXPECT_EQ(HotInSight(Values(), 3.0, Sight(false), {-0.75, 2.25}, 1.0).size(), 3U);
  const std::vector<base::Point> seen = HotInSight(Values(), 3.0, Sight(), {-0.75, 2.25}, 1.0);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_DOUBLE_EQ(seen[0].y, 2.75);
  EXPECT_DOUBLE_EQ(seen[1].x, -0.25);
}

TEST(HotInSight, RefusesARangeBelowZero) {
  EXPECT_THROW(HotInSight(Values(), 5.0, Sight(), {0.0, 2.5}, -0.1), std::invalid_argument);
  EXPECT_THROW(HotInSight(Values(), 5.0, Sight(), {std::nan(""), 2.5}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::hazards
