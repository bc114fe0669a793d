#include "robotteamsim/simulation/team_totals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace robotteamsim::simulation {
namespace {

constexpr bool kFalse[6] = {};
constexpr bool kContact[6] = {true, false, true, false, false, true};
constexpr bool kExcluded[6] = {false, false, false, false, false, true};

TEST(TeamTotals, AddUpEachRobotsColumn) {
  const double nan = std::nan("");
  // Robot 0 goes 3 m, 4 m; robot 1 stands, is away, and comes back.
  const std::vector<base::Point> positions{{0.0, 0.0}, {9.0, 9.0}, {3.0, 0.0}, {nan, nan}, {3.0, 4.0}, {9.0, 8.0}};
  TeamTotals totals(2);
  totals.AddSteps({positions.data(), 3, 2}, {kContact, 3, 2}, {kExcluded, 3, 2}, {true, true, false});
  const std::vector<RobotTotals> sums = totals.Totals();
  ASSERT_EQ(sums.size(), 2U);
  EXPECT_EQ(sums[0].distance, 7.0);
  EXPECT_EQ(sums[0].contact_steps, 2);
  EXPECT_EQ(sums[0].longest_stay, 1);
  EXPECT_EQ(sums[1].distance, 0.0);
  EXPECT_EQ(sums[1].contact_steps, 1);
  EXPECT_EQ(sums[0].excluded_steps, 0);
  EXPECT_EQ(sums[1].excluded_steps, 1);
}

TEST(TeamTotals, RefuseTablesThatDoNotFitTheTeam) {
  const std::vector<base::Point> positions(6);
  TeamTotals totals(2);
  const std::vector<bool> running(3, true);
  EXPECT_THROW(totals.AddSteps({positions.data(), 2, 3}, {kFalse, 3, 2}, {kFalse, 3, 2}, running),
               std::invalid_argument);
  EXPECT_THROW(totals.AddSteps({positions.data(), 3, 2}, {kFalse, 3, 1}, {kFalse, 3, 2}, running),
               std::invalid_argument);
  EXPECT_THROW(totals.AddSteps({positions.data(), 3, 2}, {kFalse, 3, 2}, {kFalse, 2, 2}, running),
               std::invalid_argument);
  EXPECT_THROW(totals.AddSteps({positions.data(), 3, 2}, {kFalse, 3, 2}, {kFalse, 3, 2}, {true}),
               std::invalid_argument);
  EXPECT_THROW(TeamTotals(-1), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::simulation
