#include "robotteamsim/world/outline.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);
const Polygon kBox{{-0.4, -0.1}, {0.4, -0.1}, {0.4, 0.3}, {-0.4, 0.3}};

TEST(Placed, TurnsAndMovesCorners) {
  const Polygon placed = Placed({{1.0, 0.0}, {0.0, 2.0}}, {10.0, 20.0, kPi / 2.0});
  EXPECT_NEAR(placed[0].x, 10.0, 1e-12);
  EXPECT_NEAR(placed[0].y, 21.0, 1e-12);
  EXPECT_NEAR(placed[1].x, 8.0, 1e-12);
  EXPECT_NEAR(placed[1].y, 20.0, 1e-12);
}

TEST(ReachOf, IsTheDistanceOfTheFarthestCorner) { EXPECT_DOUBLE_EQ(ReachOf(kBox), 0.5); }

TEST(HalfWidth, IsThatOfTheNarrowestStripAroundIt) { EXPECT_NEAR(HalfWidth(kBox), 0.2, 1e-12); }

}  // namespace
}  // namespace robotteamsim::world
