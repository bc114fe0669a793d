#include "robotteamsim/control/surroundings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace robotteamsim::control {
namespace {

const double kPi = std::acos(-1.0);

/// Each beam of three: right, ahead, left; places to the right, ahead and to the left, up to 1 m away.
Surroundings ThreeBeams() { return Surroundings({3, -kPi / 2, kPi / 2, 0.0, 5.0}, 1, 1.0, {-kPi / 2, 0.0, kPi / 2}); }

TEST(Surroundings, ClearestPlaceIsInTheMap) {
  // A hit 0.5 m ahead: 1 m to the right is as far from it as 1 m to the left, and comes first.
  const std::vector<float> ranges{5.0F, 0.5F, 5.0F};
  const base::Point here = *ThreeBeams().ClearestPlace({0.0, 0.0, 0.0}, ranges);
  EXPECT_NEAR(here.x, 0.0, 1e-12);
  EXPECT_NEAR(here.y, -1.0, 1e-12);
  // A robot at (3, 4) that faces left has its right ahead along x.
  const base::Point there = *ThreeBeams().ClearestPlace({3.0, 4.0, kPi / 2}, ranges);
  EXPECT_NEAR(there.x, 4.0, 1e-12);
  EXPECT_NEAR(there.y, 4.0, 1e-12);
}

TEST(Surroundings, NoPlaceIsTheClearestWithoutAHit) {
  EXPECT_FALSE(ThreeBeams().ClearestPlace({0.0, 0.0, 0.0}, std::vector<float>{5.0F, 1.5F, 5.0F}).has_value());
}

TEST(Surroundings, RefuseAPoseThatIsNotFinite) {
  const std::vector<float> ranges{5.0F, 0.5F, 5.0F};
  EXPECT_THROW(ThreeBeams().ClearestPlace({0.0, std::nan(""), 0.0}, ranges), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::control
