#include "robotteamsim/base/geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "robotteamsim/base/nearest.hpp"

namespace robotteamsim::base {
namespace {

const double kPi = std::acos(-1.0);

TEST(NormaliseAngle, KeepsPiAndTurnsMinusPiIntoIt) {
  EXPECT_DOUBLE_EQ(NormaliseAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(NormaliseAngle(-kPi), kPi);
  EXPECT_DOUBLE_EQ(NormaliseAngle(5.0 * kPi / 2.0), kPi / 2.0);
}

TEST(RelativePose, IsSeenFromTheFirstPose) {
  const Pose motion = RelativePose({1.0, 2.0, kPi / 2.0}, {0.0, 5.0, -kPi});
  EXPECT_NEAR(motion.x, 3.0, 1e-12);
  EXPECT_NEAR(motion.y, 1.0, 1e-12);
  EXPECT_NEAR(motion.yaw, kPi / 2.0, 1e-12);
}

TEST(Composed, UndoesRelativePose) {
  const Pose from{1.0, 2.0, kPi / 2.0}, motion{3.0, 1.0, kPi};
  const Pose to = Composed(from, motion);
  EXPECT_NEAR(to.x, 0.0, 1e-12);
  EXPECT_NEAR(to.y, 5.0, 1e-12);
  EXPECT_NEAR(to.yaw, -kPi / 2.0, 1e-12);
  EXPECT_NEAR(RelativePose(from, to).x, motion.x, 1e-12);
}

TEST(NearestPoint, IsTheFirstOfEquallyNearOnes) {
  EXPECT_EQ(NearestPoint({0.0, 0.0}, {{3.0, 0.0}, {0.0, -2.0}, {2.0, 0.0}}).y, -2.0);
  EXPECT_THROW(NearestPoint({0.0, 0.0}, {}), std::invalid_argument);
}

TEST(Places, AreThoseWithAPointWithinTheirReach) {
  const std::vector<Point> points{{0.0, 0.0}, {4.0, 0.0}}, places{{1.0, 0.0}, {2.0, 0.0}, {9.0, 0.0}};
  const std::vector<std::pair<int, int>> expected{{0, 0}, {1, 0}};
  EXPECT_EQ(Places(places, {1.0, 2.0, 3.0}).Reached(points), expected);
  EXPECT_THROW(Places(places, {1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::base
