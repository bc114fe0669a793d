#include "robotteamsim/world/sorted_beams.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace robotteamsim::world {
namespace {

const double kPi = std::acos(-1.0);

TEST(PseudoAngle, GrowsWithTheAngle) {
  double last = -1.0;
  for (int i = 0; i < 3600; ++i) {
    const double angle = 2.0 * kPi * (i + 0.5) / 3600;
    const double pseudo_angle = PseudoAngle(3.0 * std::cos(angle), 3.0 * std::sin(angle));
    EXPECT_GT(pseudo_angle, last);
    EXPECT_EQ(static_cast<int>(pseudo_angle), i / 900);
    last = pseudo_angle;
  }
  EXPECT_EQ(PseudoAngle(1.0, 0.0), 0.0);
  EXPECT_EQ(PseudoAngle(0.0, 0.0), 0.0);
}

TEST(SortedBeams, TakesBeamsAtTheEndsIn) {
  const SortedBeams fan(181, -0.5 * kPi, 0.5 * kPi);
  int count = 0;
  const auto place = [&](int beam) { return PseudoAngle(fan.X()[beam], fan.Y()[beam]); };
  fan.ForBeamsBetween(place(10), place(20), [&](int first, int end) { count += end - first; });
  EXPECT_EQ(count, 11);
}

}  // namespace
}  // namespace robotteamsim::world
