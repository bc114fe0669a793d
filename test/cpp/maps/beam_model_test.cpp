#include "robotteamsim/maps/beam_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace robotteamsim::maps {
namespace {

/// Ten by ten metres in cells of 0.1 m, with a wall from x = 8 on.
std::shared_ptr<const DistanceField> WallAheadAt8() {
  std::vector<std::uint8_t> occupied(100 * 100, 0);
  for (int row = 0; row < 100; ++row) {
    for (int col = 80; col < 100; ++col) occupied[row * 100 + col] = 1;
  }
  return std::make_shared<DistanceField>(plan::GridShape{{0.0, 0.0}, 0.1, 100, 100}, occupied);
}

/// A laser at base_link with beams to the right, ahead and to the left, of at most 5 m.
const world::Fan kThree{3, -1.5707963267948966, 1.5707963267948966, 0.0, 0.0, 5.0};
const base::Pose kThreeMetresBefore{5.0, 5.0, 0.0};
const float kNone = std::numeric_limits<float>::infinity();

TEST(BeamModel, ScanThatFitsHasLikelihoodOne) {
  const BeamModel model(WallAheadAt8(), kThree, 0.05);
  const std::vector<float> scan{kNone, 3.0F, 5.0F};  // no return, as inf and as the longest range
  EXPECT_NEAR(model.LogLikelihood(kThreeMetresBefore, model.BeamsOf(scan.data(), 3, {0, 1, 2}), 0.1, 0.05), 0.0, 1e-9);
}

TEST(BeamModel, RangeIsAsLikelyAsItsDeviation) {
  const BeamModel model(WallAheadAt8(), kThree, 0.05);
  const auto log_likelihood = [&](float ahead_m) {
    const std::vector<float> scan{kNone, ahead_m, kNone};
    return model.LogLikelihood(kThreeMetresBefore, model.BeamsOf(scan.data(), 3, {1}), 0.1, 0.05);
  };
  EXPECT_NEAR(log_likelihood(3.1F), std::log(0.95 * std::exp(-0.5) + 0.05), 1e-5);
  EXPECT_NEAR(log_likelihood(2.8F), std::log(0.95 * std::exp(-2.0) + 0.05), 1e-5);
  // A person in the way, and a beam that should have returned.
  EXPECT_NEAR(log_likelihood(1.0F), std::log(0.05), 1e-9);
  EXPECT_NEAR(log_likelihood(kNone), std::log(0.05), 1e-9);
}

TEST(BeamModel, LogarithmOfManyBeamsThatDoNotFitIsFinite) {
  world::Fan fan = kThree;
  fan.beams = 1001;
  const BeamModel model(WallAheadAt8(), fan, 0.05);
  const std::vector<float> scan(1001, 0.5F);
  std::vector<int> all(1001);
  for (int i = 0; i < 1001; ++i) all[i] = i;
  EXPECT_NEAR(model.LogLikelihood(kThreeMetresBefore, model.BeamsOf(scan.data(), 1001, all), 0.1, 1e-3),
              1001 * std::log(1e-3), 1e-6);
}

TEST(BeamModel, CountsBeamsThatHitAndThoseThatContradict) {
  const BeamModel model(WallAheadAt8(), kThree, 0.05);
  const auto agreement = [&](const std::vector<float>& scan) {
    return model.AgreementOf(kThreeMetresBefore, model.BeamsOf(scan.data(), 3, {0, 1, 2}), {0.3, 0.05});
  };
  EXPECT_EQ(agreement({kNone, 3.2F, kNone}).informative, 1);
  EXPECT_EQ(agreement({kNone, 3.2F, kNone}).contradicting, 0);
  EXPECT_EQ(agreement({kNone, kNone, kNone}).contradicting, 1);
  EXPECT_EQ(agreement({2.0F, 1.0F, kNone}).informative, 2);
  EXPECT_EQ(agreement({2.0F, 1.0F, kNone}).contradicting, 2);
}

TEST(BeamModel, BeamNearAnEdgeDoesNotContradict) {
  // A pillar of one cell straight ahead in 2 m: a beam that passes it would hit it if the robot had turned by 1.5
  // degrees.
  std::vector<std::uint8_t> occupied(100 * 100, 0);
  occupied[50 * 100 + 70] = 1;
  const BeamModel model(std::make_shared<DistanceField>(plan::GridShape{{0.0, 0.0}, 0.1, 100, 100}, occupied), kThree,
                        0.05);
  const std::vector<float> scan{kNone, kNone, kNone};
  const auto contradicting = [&](double tolerance_rad) {
    return model.AgreementOf({5.0, 5.05, 0.0}, model.BeamsOf(scan.data(), 3, {1}), {0.3, tolerance_rad}).contradicting;
  };
  EXPECT_EQ(contradicting(0.05), 0);
  EXPECT_EQ(contradicting(0.01), 1);
}

TEST(BeamModel, LeavesOutBeamsWithoutANumber) {
  const BeamModel model(WallAheadAt8(), kThree, 0.05);
  const std::vector<float> scan{std::nanf(""), 3.0F, -kNone};
  const std::vector<Beam> beams = model.BeamsOf(scan.data(), 3, {0, 1, 2});
  ASSERT_EQ(beams.size(), 2U);
  EXPECT_EQ(beams[1].range_m, 0.05);  // too near, as in REP-117
}

TEST(BeamModel, RefusesWhatNoLaserHas) {
  const BeamModel model(WallAheadAt8(), kThree, 0.05);
  const std::vector<float> scan{1.0F, 1.0F, 1.0F};
  EXPECT_THROW(model.BeamsOf(scan.data(), 2, {0}), std::invalid_argument);
  EXPECT_THROW(model.BeamsOf(scan.data(), 3, {3}), std::invalid_argument);
  EXPECT_THROW(BeamModel(WallAheadAt8(), kThree, 5.0), std::invalid_argument);
  world::Fan none = kThree;
  none.beams = 0;
  EXPECT_THROW(BeamModel(WallAheadAt8(), none, 0.05), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
