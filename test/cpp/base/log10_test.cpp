#include "robotteamsim/base/log10.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace robotteamsim::base {
namespace {

/// How far from the true value, in units of its last place.
double UnitsOff(double x) {
  const long double exact = std::log10(static_cast<long double>(x));
  const auto nearest = static_cast<double>(exact);
  const double unit = std::nextafter(std::abs(nearest), std::numeric_limits<double>::infinity()) - std::abs(nearest);
  return static_cast<double>(std::abs(static_cast<long double>(Log10(x)) - exact)) / unit;
}

TEST(Log10, IsWithinThreeUnitsInTheLastPlaceOfEverySquaredDistance) {
  std::mt19937_64 generator(31);
  double worst = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    const auto exponent = static_cast<double>(generator() >> 11) * 0x1p-53 * 17.0 - 5.0;  // 3 mm .. 1000 km, squared
    worst = std::max(worst, UnitsOff(std::pow(10.0, exponent)));
  }
  EXPECT_LT(worst, 3.0);
  EXPECT_GT(worst, 0.0);
}

TEST(Log10, IsWithinOneUnitOfTheLibraryNearOne) {
  for (int i = -100'000; i <= 100'000; ++i) {
    const double x = 1.0 + i * 1e-6;
    ASSERT_NEAR(Log10(x), std::log10(x), 1e-16) << x;
    ASSERT_LT(UnitsOff(x), 3.0) << x;
  }
}

TEST(Log10, IsExactAtOneAndRisesAcrossPowersOfTwoAndTheirRoots) {
  EXPECT_EQ(Log10(1.0), 0.0);
  for (const double x :
       {0.25, 0.5, 0.70710678118654757, 1.0, 1.4142135623730951, 2.0, 4.0, 1024.0, 0x1p-1000, 0x1p1000}) {
    EXPECT_LT(UnitsOff(x), 3.0) << x;
    EXPECT_LE(Log10(std::nextafter(x, 0.0)), Log10(x) + 1e-16 * std::abs(Log10(x)) * 4.0) << x;
  }
}

TEST(Log10, OfPowersOfTenIsTheirExponent) {
  for (int exponent = -12; exponent <= 12; ++exponent) {
    EXPECT_NEAR(Log10(std::pow(10.0, exponent)), exponent, 4e-15) << exponent;
  }
}

}  // namespace
}  // namespace robotteamsim::base
