#include "robotteamsim/world/sorted_beams.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

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

// Compares with the angle of every beam, one by one.
void ExpectRightBeams(int beams, double angle_min_rad, double angle_max_rad) {
  const SortedBeams fan(beams, angle_min_rad, angle_max_rad);
  ASSERT_EQ(fan.Count(), beams);
  std::mt19937 random(beams);
  std::uniform_real_distribution<double> direction(-kPi, kPi), width(1e-4, 3.1);
  for (int i = 0; i < 300; ++i) {
    const double right = direction(random), left = right + width(random);
    std::vector<bool> met(beams, false);
    const auto pseudo_angle = [&](double angle) {
      return PseudoAngle(std::cos(angle - fan.Zero()), std::sin(angle - fan.Zero()));
    };
    fan.ForBeamsBetween(pseudo_angle(right), pseudo_angle(left), [&](int first, int end) {
      for (int place = first; place < end; ++place) met[place] = true;
    });
    for (int beam = 0; beam < beams; ++beam) {
      const double angle = angle_min_rad + (beams > 1 ? beam * (angle_max_rad - angle_min_rad) / (beams - 1) : 0.0);
      double beyond = std::remainder(angle - right, 2.0 * kPi);
      if (beyond < 0.0) beyond += 2.0 * kPi;
      EXPECT_EQ(met[fan.PlaceOf(beam)], beyond <= left - right) << "beam " << beam << " of " << beams;
    }
  }
}

TEST(SortedBeams, FindsTheBeamsBetweenTwoDirections) {
  ExpectRightBeams(181, -0.5 * kPi, 0.5 * kPi);
  ExpectRightBeams(1081, -2.3562, 2.3562);
  ExpectRightBeams(360, -kPi, kPi);  // the last beam is the first one again
  ExpectRightBeams(91, 2.0, -2.0);   // clockwise
  ExpectRightBeams(100, -6.0, 6.0);  // nearly two turns
  ExpectRightBeams(2, 0.0, kPi);
  ExpectRightBeams(1, 0.7, 0.7);
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
