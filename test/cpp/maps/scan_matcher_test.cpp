#include "robotteamsim/maps/scan_matcher.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "rooms.hpp"

namespace robotteamsim::maps {
namespace {

const MatcherParameters kParameters{0.3, 0.07, 0.02, 0.03};
/// Of standard deviations of 0.1 m and 0.05 rad.
const Eigen::Matrix3d kLoose = Eigen::Vector3d(100.0, 100.0, 400.0).asDiagonal();

LogOddsMap MapOf(const Walls& walls, const std::vector<base::Pose>& poses) {
  LogOddsMap map(0.05);
  for (const base::Pose& pose : poses) map.Insert(ScanIn(walls, pose), pose);
  return map;
}

TEST(ScanMatcher, FindsThePoseInARoom) {
  const Walls room = Rectangle(-3.0, -2.0, 3.0, 2.0);
  const LogOddsMap map = MapOf(room, {{0.0, 0.0, 0.0}, {0.5, 0.3, 0.4}, {-0.6, 0.2, 1.0}});
  const base::Pose truth{0.4, -0.3, 0.2};
  const Match match = ScanMatcher(kParameters).Align(map, ScanIn(room, truth).hits, {0.45, -0.26, 0.22}, kLoose);
  EXPECT_NEAR(match.pose.x, truth.x, 0.002);
  EXPECT_NEAR(match.pose.y, truth.y, 0.002);
  EXPECT_NEAR(match.pose.yaw, truth.yaw, 0.001);
  EXPECT_GT(match.points, 150);
  EXPECT_LT(match.misfit_m, 0.005);
}

TEST(ScanMatcher, HasNoInformationAlongACorridor) {
  const Walls corridor{{{-50.0, 1.0}, {50.0, 1.0}}, {{-50.0, -1.0}, {50.0, -1.0}}};
  const LogOddsMap map = MapOf(corridor, {{0.0, 0.0, 0.0}, {0.2, 0.0, 0.0}});
  const Match match = ScanMatcher(kParameters).Align(map, ScanIn(corridor, {}).hits, {0.05, 0.03, 0.01}, kLoose);
  EXPECT_LT(match.information(0, 0), 1e-3 * match.information(1, 1));
  EXPECT_NEAR(match.pose.x, 0.05, 0.002);  // as predicted
  EXPECT_NEAR(match.pose.y, 0.0, 0.002);
}

TEST(ScanMatcher, DoesNotTakeOneSideOfAWallForTheOther) {
  // The map has the left side of a wall of 0.15 m, which the robot now sees from the right.
  const LogOddsMap map = MapOf({{{1.0, -3.0}, {1.0, 3.0}}}, {{0.0, 0.0, 0.0}, {0.0, 0.5, 0.0}});
  const Walls right_side{{{1.15, -3.0}, {1.15, 3.0}}};
  const base::Pose pose{2.0, 0.0, 0.0};
  const Match match = ScanMatcher(kParameters).Align(map, ScanIn(right_side, pose).hits, pose, kLoose);
  EXPECT_EQ(match.points, 0);
  EXPECT_EQ(match.pose.x, pose.x);
}

TEST(ScanMatcher, StaysAtThePredictionInAnEmptyMap) {
  const Scan scan = ScanIn(Rectangle(-1.0, -1.0, 1.0, 1.0), {});
  const Match match = ScanMatcher(kParameters).Align(LogOddsMap(0.05), scan.hits, {1.0, 2.0, 3.0}, kLoose);
  EXPECT_EQ(match.points, 0);
  EXPECT_EQ(match.pose.x, 1.0);
  EXPECT_EQ(match.information, Eigen::Matrix3d::Zero());
}

TEST(ScanMatcher, RefusesParametersThatAreNotPositive) {
  for (double MatcherParameters::*member : {&MatcherParameters::reach_m, &MatcherParameters::kernel_m,
                                            &MatcherParameters::sigma_m, &MatcherParameters::outlier_m}) {
    MatcherParameters parameters = kParameters;
    parameters.*member = 0.0;
    EXPECT_THROW(ScanMatcher{parameters}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace robotteamsim::maps
