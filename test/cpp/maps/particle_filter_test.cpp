#include "robotteamsim/maps/particle_filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace robotteamsim::maps {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Ten by ten metres in cells of 0.1 m, with a wall from x = 8 on, and a laser with one beam ahead.
std::shared_ptr<const BeamModel> OneBeamBeforeAWall() {
  std::vector<std::uint8_t> occupied(100 * 100, 0);
  for (int row = 0; row < 100; ++row) {
    for (int col = 80; col < 100; ++col) occupied[row * 100 + col] = 1;
  }
  auto field = std::make_shared<DistanceField>(plan::GridShape{{0.0, 0.0}, 0.1, 100, 100}, occupied);
  return std::make_shared<BeamModel>(field, world::Fan{1, 0.0, 0.0, 0.0, 0.0, 5.0}, 0.05);
}

/// Particles where the rows of `noise` say.
template <std::size_t size>
ParticleFilter At(std::array<double, size> noise, const base::Pose& mean = {}) {
  return ParticleFilter(OneBeamBeforeAWall(), {0.1, 0.05, 1.0}, mean, {1.0, 1.0, 1.0}, {noise.data(), size / 3, 3});
}

TEST(ParticleFilter, MeanAndCovarianceAreThoseOfTheParticles) {
  const ParticleFilter filter = At<6>({1.0, 2.0, 0.1, 3.0, 6.0, 0.3});
  const auto [pose, covariance] = filter.Mean();
  EXPECT_DOUBLE_EQ(pose.x, 2.0);
  EXPECT_DOUBLE_EQ(pose.y, 4.0);
  EXPECT_NEAR(pose.yaw, 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(covariance.xx, 1.0);
  EXPECT_DOUBLE_EQ(covariance.xy, 2.0);
  EXPECT_DOUBLE_EQ(covariance.yy, 4.0);
  EXPECT_NEAR(covariance.x_yaw, 0.1, 1e-12);
  EXPECT_NEAR(covariance.yaw_yaw, 0.01, 1e-12);
}

TEST(ParticleFilter, MeanHeadingOfOppositeSidesOfPiIsPi) {
  const auto [pose, covariance] = At<6>({0.0, 0.0, kPi - 0.1, 0.0, 0.0, -kPi + 0.1}).Mean();
  EXPECT_NEAR(std::abs(pose.yaw), kPi, 1e-9);
  EXPECT_NEAR(covariance.yaw_yaw, 0.01, 1e-9);
}

TEST(ParticleFilter, MovesWithTheErrorsOfTheOdometry) {
  const sensing::OdometryModel model{0.01, 0.001, 0.001, 0.0001};
  const base::Pose motion{0.06, 0.004, 0.13};
  std::array<double, 3> noise{0.7, -1.2, 0.4};
  ParticleFilter filter = At<3>({1.0, 2.0, 0.5});
  filter.Move({model, motion, motion.yaw, false}, {noise.data(), 1, 3});
  // The same step of an odometry whose frame is where the particle was.
  sensing::Odometry odometry(model, 0.1);
  odometry.Step(motion, {0.6, 0.0, 1.3}, {0.7, -1.2, 0.4});
  const base::Pose moved = base::RelativePose({1.0, 2.0, 0.5}, filter.particles()[0]);
  EXPECT_NEAR(moved.x, odometry.pose().x, 1e-12);
  EXPECT_NEAR(moved.y, odometry.pose().y, 1e-12);
  EXPECT_NEAR(moved.yaw, odometry.pose().yaw, 1e-12);
}

TEST(ParticleFilter, WeighsByTheLikelihoodOfTheScan) {
  // 3 m and 3.1 m before the wall; the laser measures 3 m.
  ParticleFilter filter = At<6>({5.0, 5.0, 0.0, 4.9, 5.0, 0.0});
  filter.Weigh({{0, 3.0}});
  const double other = 0.95 * std::exp(-0.5) + 0.05;
  EXPECT_NEAR(filter.weights()[0], 1.0 / (1.0 + other), 1e-6);
  EXPECT_NEAR(filter.weights()[1], other / (1.0 + other), 1e-6);
}

TEST(ParticleFilter, WeightsHaveASumThoughNothingFits) {
  ParticleFilter filter = At<6>({50.0, 5.0, 0.0, -40.0, 5.0, 0.0});
  for (int i = 0; i < 2000; ++i) filter.Weigh({{0, 3.0}, {0, 2.0}, {0, 1.0}});
  EXPECT_EQ(filter.weights()[0], 0.5);
  EXPECT_EQ(filter.weights()[1], 0.5);
}

TEST(ParticleFilter, ResamplesInProportionToTheWeights) {
  // One particle before the wall, three elsewhere: weights 0.87 and 0.043, so about two thirds of an effective
  // particle.
  ParticleFilter filter = At<12>({5.0, 5.0, 0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 0.0, 1.0, 3.0, 0.0});
  filter.Weigh({{0, 3.0}});
  filter.Resample(0.2);
  // At 0.05, 0.3, 0.55 and 0.8 of the sum of weights.
  for (const base::Pose& particle : filter.particles()) EXPECT_EQ(particle.x, 5.0);
  for (const double weight : filter.weights()) EXPECT_EQ(weight, 0.25);
}

TEST(ParticleFilter, DrawsSomeParticlesByTheirWeightsAndKeepsAll) {
  // Weights 0.87 and 0.043: of two, at 0.35 and 0.85 of their sum, both are the particle before the wall.
  ParticleFilter filter = At<12>({5.0, 5.0, 0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 0.0, 1.0, 3.0, 0.0});
  filter.Weigh({{0, 3.0}});
  const std::vector<double> before = filter.weights();
  const std::vector<base::Pose> two = filter.Drawn(2, 0.7);
  ASSERT_EQ(two.size(), 2u);
  for (const base::Pose& particle : two) EXPECT_EQ(particle.x, 5.0);
  EXPECT_EQ(filter.Drawn(1, 0.99)[0].y, 3.0);
  EXPECT_TRUE(filter.Drawn(0, 0.5).empty());
  EXPECT_EQ(filter.weights(), before);
  EXPECT_EQ(filter.particles()[3].y, 3.0);
  EXPECT_THROW(filter.Drawn(5, 0.5), std::invalid_argument);
  EXPECT_THROW(filter.Drawn(2, 1.0), std::invalid_argument);
}

TEST(ParticleFilter, KeepsParticlesOfSimilarWeights) {
  ParticleFilter filter = At<6>({5.0, 5.0, 0.0, 4.9, 5.0, 0.0});
  filter.Weigh({{0, 3.0}});
  const std::vector<double> before = filter.weights();
  filter.Resample(0.2);
  EXPECT_EQ(filter.weights(), before);
}

TEST(ParticleFilter, ShiftsToAnotherLevel) {
  ParticleFilter filter = At<3>({1.0, 2.0, 0.5});
  filter.Shift({30.0, -1.0});
  EXPECT_EQ(filter.particles()[0].x, 31.0);
  EXPECT_EQ(filter.particles()[0].y, 1.0);
}

TEST(ParticleFilter, RefusesWhatIsNoDistribution) {
  std::array<double, 3> noise{0.0, 0.0, 0.0};
  const auto made = [&](ScanWeighing weighing, std::size_t rows) {
    return ParticleFilter(OneBeamBeforeAWall(), weighing, {}, {1.0, 1.0, 1.0}, {noise.data(), rows, 3});
  };
  EXPECT_THROW(made({0.0, 0.05, 1.0}, 1), std::invalid_argument);
  EXPECT_THROW(made({0.1, 1.0, 1.0}, 1), std::invalid_argument);
  EXPECT_THROW(made({0.1, 0.05, 1.0}, 0), std::invalid_argument);
  ParticleFilter one = made({0.1, 0.05, 1.0}, 1);
  EXPECT_THROW(one.Resample(1.0), std::invalid_argument);
  noise[1] = std::nan("");
  EXPECT_THROW(made({0.1, 0.05, 1.0}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
