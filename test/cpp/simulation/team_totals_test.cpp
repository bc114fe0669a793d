#include "robotteamsim/simulation/team_totals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace robotteamsim::simulation {
namespace {

TEST(TeamTotals, AddUpEachRobotsSteps) {
  const double nan = std::nan("");
  // Robot 0 goes 3 m, 4 m; robot 1 stands, is away, and comes back.
  TeamTotals totals(2, 5.0);
  totals.AddStep({{0.0, 0.0}, {9.0, 9.0}}, {true, false}, {false, false}, true);
  totals.AddStep({{3.0, 0.0}, {nan, nan}}, {true, false}, {false, false}, true);
  totals.AddStep({{3.0, 4.0}, {9.0, 8.0}}, {false, true}, {false, true}, false);
  const std::vector<RobotTotals> sums = totals.Totals();
  ASSERT_EQ(sums.size(), 2U);
  EXPECT_EQ(sums[0].distance_m, 7.0);
  EXPECT_EQ(sums[0].contact_steps, 2);
  EXPECT_EQ(sums[0].longest_stay, 1);
  EXPECT_EQ(sums[1].distance_m, 0.0);
  EXPECT_EQ(sums[1].contact_steps, 1);
  EXPECT_EQ(sums[0].excluded_steps, 0);
  EXPECT_EQ(sums[1].excluded_steps, 1);
}

TEST(TeamTotals, LeaveOutJumps) {
  TeamTotals totals(1, 5.0);
  for (const double x : {0.0, 5.0, 10.5, 12.0}) totals.AddStep({{x, 0.0}}, {false}, {false}, true);
  EXPECT_EQ(totals.Totals()[0].distance_m, 6.5);
}

TEST(TeamTotals, RefuseStepsThatDoNotFitTheTeam) {
  TeamTotals totals(2, 5.0);
  EXPECT_THROW(totals.AddStep({{}, {}, {}}, {false, false}, {false, false}, true), std::invalid_argument);
  EXPECT_THROW(totals.AddStep({{}, {}}, {false}, {false, false}, true), std::invalid_argument);
  EXPECT_THROW(totals.AddStep({{}, {}}, {false, false}, {false}, true), std::invalid_argument);
  EXPECT_THROW(TeamTotals(-1, 5.0), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::simulation
