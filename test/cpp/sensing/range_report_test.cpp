#include "robotteamsim/sensing/range_report.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

namespace robotteamsim::sensing {
namespace {

const double kInfinity = std::numeric_limits<double>::infinity();
const double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<float> Reported(const RangeLimits& limits, const std::vector<double>& noise_m = {}) {
  const std::vector<double> ranges_m{0.01, 0.05, 5.0, kInfinity};
  std::vector<float> reported_m(4);
  const base::Table<const double> noise{noise_m.data(), noise_m.empty() ? 0U : 2U, 2};
  Report(limits, {ranges_m.data(), 2, 2}, noise, {reported_m.data(), 2, 2});
  return reported_m;
}

TEST(Report, HasWhatTheSensorReportsInsteadOfWhatItCannotMeasure) {
  EXPECT_EQ(Reported({0.05, 5.0, 0.05, 5.0}), (std::vector<float>{0.05F, 0.05F, 5.0F, 5.0F}));
  const float infinity = std::numeric_limits<float>::infinity();
  const RangeLimits limits{0.05, 5.0, -kInfinity, kInfinity};
  EXPECT_EQ(Reported(limits), (std::vector<float>{-infinity, 0.05F, 5.0F, infinity}));
  EXPECT_EQ(Reported(limits, {0.5, -0.01, 0.1, -9.0}), (std::vector<float>{0.51F, -infinity, infinity, infinity}));
}

TEST(Report, RefusesImpossibleLimitsAndTablesOfAnotherShape) {
  EXPECT_THROW(Reported({5.0, 5.0, 5.0, 5.0}), std::invalid_argument);
  EXPECT_THROW(Reported({-1.0, 5.0, 0.0, 5.0}), std::invalid_argument);
  EXPECT_THROW(Reported({0.0, 5.0, kNan, 5.0}), std::invalid_argument);
  // Reported in single precision, whose largest number is 3.4e38, these would become infinite.
  EXPECT_THROW(Reported({0.0, 5.0, 1e39, 5.0}), std::invalid_argument);
  EXPECT_THROW(Reported({0.0, 5.0, 0.0, -1e39}), std::invalid_argument);
  EXPECT_THROW(Reported({0.0, 1e39, 0.0, 5.0}), std::invalid_argument);
  const std::vector<double> ranges_m(4), noise_m(4);
  std::vector<float> reported_m(4);
  const base::Table<float> reported{reported_m.data(), 2, 2};
  EXPECT_THROW(Report({}, {ranges_m.data(), 1, 4}, {}, reported), std::invalid_argument);
  EXPECT_THROW(Report({}, {ranges_m.data(), 2, 2}, {noise_m.data(), 1, 4}, reported), std::invalid_argument);
}

TEST(Dim, RemovesWhatSmokeHidesFromEachRobot) {
  const world::Fan fan{3, -0.5, 0.5};
  std::vector<float> reported_m{2.0F, 2.0F, 2.0F, 1.0F, 1.0F, 1.0F, 2.0F, 2.0F, 2.0F};
  const base::Table<float> rows{reported_m.data(), 3, 3};
  const hazards::Haze haze({{-10.0, -10.0}, 1.0, 20, 20}, std::vector<float>(20 * 20, 1.0F), 1.0, 1.5);
  const std::vector<base::Pose> robots{{1.0, -3.0, 0.0}, {2.0, 3.0, 0.0}, {kNan, kNan, kNan}};
  Dim(fan, robots, haze, 5.0, rows);
  EXPECT_EQ(reported_m[1], 5.0F);  // 2 m away: beyond the sight of 1.5 m
  EXPECT_EQ(reported_m[4], 1.0F);
  EXPECT_EQ(reported_m[7], 2.0F);  // of an absent robot
  EXPECT_THROW(Dim(fan, {robots[0]}, haze, 5.0, rows), std::invalid_argument);
  EXPECT_THROW(Dim(fan, robots, haze, 1e39, rows), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::sensing
