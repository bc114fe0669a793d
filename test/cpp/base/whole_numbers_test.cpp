#include "robotteamsim/base/whole_numbers.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace robotteamsim::base {
namespace {

std::int64_t FloorByIntegers(std::int64_t numerator, std::int64_t positive) {
  const std::int64_t quotient = numerator / positive;
  return quotient - (numerator % positive < 0 ? 1 : 0);
}

TEST(FloorDivide, RoundsDown) {
  EXPECT_EQ(FloorDivide(7, 2), 3);
  EXPECT_EQ(FloorDivide(-7, 2), -4);
  EXPECT_EQ(FloorDivide(-8, 2), -4);
  EXPECT_EQ(FloorDivide(0, 5), 0);
}

TEST(FloorDivide, IsExactBesideMultiplesOfAnySize) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 1'000'000; ++i) {
    const auto divisor = static_cast<std::int64_t>(generator() >> (2 + generator() % 61)) + 1;
    const std::int64_t largest = std::int64_t{9'000'000'000'000'000'000} / divisor;
    const auto quotient = static_cast<std::int64_t>(generator() % static_cast<std::uint64_t>(largest));
    for (const std::int64_t sign : {-1, 1}) {
      for (const std::int64_t beside : {-1, 0, 1}) {
        const std::int64_t numerator = sign * quotient * divisor + beside;
        ASSERT_EQ(FloorDivide(numerator, divisor), FloorByIntegers(numerator, divisor)) << numerator << " " << divisor;
      }
    }
  }
}

}  // namespace
}  // namespace robotteamsim::base
