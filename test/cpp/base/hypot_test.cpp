#include "robotteamsim/base/hypot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace robotteamsim::base {
namespace {

TEST(Hypot, OfWholeTrianglesIsWhole) {
  EXPECT_EQ(Hypot(3.0, 4.0), 5.0);
  EXPECT_EQ(Hypot(-5.0, 12.0), 13.0);
  EXPECT_EQ(Hypot(0.0, -7.0), 7.0);
  EXPECT_EQ(Hypot(0.0, 0.0), 0.0);
}

TEST(Hypot, ScalesWithPowersOfTwo) {
  const double length = Hypot(1.1, 0.7);
  for (const int exponent : {-900, -500, -3, 5, 470, 1000}) {
    EXPECT_EQ(Hypot(std::ldexp(0.7, exponent), std::ldexp(-1.1, exponent)), std::ldexp(length, exponent)) << exponent;
  }
}

TEST(Hypot, OfWhatIsNoNumberIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(Hypot(nan, 1.0)));
  EXPECT_TRUE(std::isnan(Hypot(0.0, nan)));
  EXPECT_EQ(Hypot(-inf, nan), inf);
}

}  // namespace
}  // namespace robotteamsim::base
