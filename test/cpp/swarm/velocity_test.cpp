#include "robotteamsim/swarm/velocity.hpp"

#include <gtest/gtest.h>

#include <array>

namespace robotteamsim::swarm {
namespace {

TEST(NextVelocity, IsTheInertiaAndFourWeightedPulls) {
  const std::array<Pull, 4> pulls{Pull{0.8, 0.5, {2.0, 1.0}}, Pull{0.1, 1.0, {5.0, 1.0}}, Pull{0.2, 0.5, {1.0, 0.0}},
                                  Pull{0.4, 0.25, {1.0, -9.0}}};
  const base::Point velocity = NextVelocity({1.0, 1.0}, {0.1, 0.2}, pulls);
  EXPECT_NEAR(velocity.x, 0.1 + 0.8 * 0.5 * 1.0 + 0.1 * 1.0 * 4.0, 1e-12);
  EXPECT_NEAR(velocity.y, 0.2 - 0.2 * 0.5 * 1.0 - 0.4 * 0.25 * 10.0, 1e-12);
}

TEST(NextVelocity, OfARobotAtItsAttractorsIsItsInertia) {
  const base::Point here{3.0, 4.0};
  const Pull pull{1.0, 0.7, here};
  const base::Point velocity = NextVelocity(here, {0.3, -0.1}, {pull, pull, pull, pull});
  EXPECT_EQ(velocity.x, 0.3);
  EXPECT_EQ(velocity.y, -0.1);
}

}  // namespace
}  // namespace robotteamsim::swarm
