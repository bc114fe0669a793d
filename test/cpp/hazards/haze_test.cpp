#include "robotteamsim/hazards/haze.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace robotteamsim::hazards {
namespace {

/// 20 m x 10 m in cells of 0.5 m: smoke of 0.5/m in the western half, clear air in the other. Light is gone at 1.5.
Haze HalfAHall() {
  std::vector<float> soot_g_m3(20 * 40, 0.0F);
  for (int cell = 0; cell < 20 * 40; ++cell) soot_g_m3[cell] = cell % 40 < 20 ? 0.5F : 0.0F;
  return Haze({{0.0, 0.0}, 0.5, 20, 40}, soot_g_m3, 1.0, 1.5);
}

TEST(Haze, LightGetsAsFarAsTheOpticalDepthAllows) {
  const base::Point east{1.0, 0.0}, west{-1.0, 0.0};
  EXPECT_NEAR(HalfAHall().Sight({1.2, 5.1}, east, 30.0), 3.0, 1e-9);
  EXPECT_EQ(HalfAHall().Sight({7.5, 5.1}, east, 10.0), 10.0);  // 2.5 m of smoke, then clear
  EXPECT_NEAR(HalfAHall().Sight({7.5, 5.1}, west, 10.0), 3.0, 1e-9);
  EXPECT_EQ(HalfAHall().Sight({1.2, 5.1}, east, 2.0), 2.0);
}

TEST(Haze, IsClearAroundAPointWhereNoLineReachesTheLimit) {
  EXPECT_FALSE(HalfAHall().IsClearAround({5.0, 5.0}, 3.5));
  EXPECT_TRUE(HalfAHall().IsClearAround({5.0, 5.0}, 2.9));
  EXPECT_TRUE(HalfAHall().IsClearAround({15.0, 5.0}, 4.0));
}

}  // namespace
}  // namespace robotteamsim::hazards
