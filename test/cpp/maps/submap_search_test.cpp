#include "robotteamsim/maps/submap_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace robotteamsim::maps {
namespace {

/// A plan of 20 m x 12 m in cells of 0.1 m.
class Plan {
 public:
  void Fill(double x0, double y0, double x1, double y1) {
    for (int row = Cell(y0); row < Cell(y1); ++row) {
      for (int col = Cell(x0); col < Cell(x1); ++col) occupied_[row * shape_.cols + col] = 1;
    }
  }
  SubmapSearch Search() const { return SubmapSearch(shape_, occupied_, 0.15); }

 private:
  static int Cell(double m) { return static_cast<int>(std::lround(m * 10.0)); }

  plan::GridShape shape_{{0.0, 0.0}, 0.1, 120, 200};
  std::vector<std::uint8_t> occupied_ = std::vector<std::uint8_t>(120 * 200, 0);
};

/// Points on walls around (x, y), in the frame of a robot there with a heading.
std::vector<base::Point> SeenFrom(const base::Pose& robot, const std::vector<base::Point>& on_walls) {
  std::vector<base::Point> seen;
  for (const base::Point& point : on_walls) {
    const base::Pose relative = base::RelativePose(robot, {point.x, point.y, 0.0});
    seen.push_back({relative.x, relative.y});
  }
  return seen;
}

/// Points along the inner faces of a corner with its sides along the axes, the longer one along x.
std::vector<base::Point> Corner(double x, double y, double sign) {
  std::vector<base::Point> points;
  for (int i = 0; i < 40; ++i) points.push_back({x + sign * 0.1 * i, y});
  for (int i = 0; i < 25; ++i) points.push_back({x, y + sign * 0.1 * i});
  return points;
}

TEST(SubmapSearch, FindsTheOnlyCorner) {
  Plan plan;
  plan.Fill(2.9, 1.9, 7.0, 2.0);
  plan.Fill(2.9, 1.9, 3.0, 4.6);
  const base::Pose robot{5.0, 4.0, 2.1};
  const auto matches = plan.Search().Find(SeenFrom(robot, Corner(3.0, 2.0, 1.0)), {});
  ASSERT_GE(matches.size(), 1U);
  EXPECT_NEAR(matches[0].pose.x, robot.x, 0.2);
  EXPECT_NEAR(matches[0].pose.y, robot.y, 0.2);
  EXPECT_NEAR(matches[0].pose.yaw, robot.yaw, 0.06);
  EXPECT_EQ(matches[0].share, 1.0);
}

TEST(SubmapSearch, FindsBothPlacesOfASymmetricalPlan) {
  Plan plan;
  plan.Fill(2.9, 1.9, 7.0, 2.0);
  plan.Fill(2.9, 1.9, 3.0, 4.6);
  // The same, turned by half about (10, 6).
  plan.Fill(13.0, 10.0, 17.1, 10.1);
  plan.Fill(17.0, 7.4, 17.1, 10.1);
  SubmapSearch::Limits limits;
  limits.ratio = 0.95;
  const auto matches = plan.Search().Find(SeenFrom({5.0, 4.0, 0.0}, Corner(3.0, 2.0, 1.0)), limits);
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].share, 1.0);
  EXPECT_EQ(matches[1].share, 1.0);
  const bool first_is_straight = std::abs(matches[0].pose.yaw) < 1.0;
  EXPECT_NEAR(matches[first_is_straight ? 0 : 1].pose.x, 5.0, 0.2);
  EXPECT_NEAR(matches[first_is_straight ? 1 : 0].pose.x, 15.0, 0.2);
  EXPECT_NEAR(matches[first_is_straight ? 1 : 0].pose.y, 8.0, 0.2);
}

TEST(SubmapSearch, FindsNothingWhereNothingFits) {
  Plan plan;
  plan.Fill(2.0, 2.0, 2.2, 2.2);
  EXPECT_TRUE(plan.Search().Find(SeenFrom({5.0, 4.0, 0.0}, Corner(3.0, 2.0, 1.0)), {}).empty());
  EXPECT_TRUE(plan.Search().Find({}, {}).empty());
}

TEST(SubmapSearch, StopsWhereItFitsEverywhere) {
  Plan plan;
  plan.Fill(0.0, 0.0, 20.0, 12.0);
  SubmapSearch::Limits limits;
  limits.most = 5;
  EXPECT_EQ(plan.Search().Find(SeenFrom({5.0, 4.0, 0.0}, Corner(3.0, 2.0, 1.0)), limits).size(), 5U);
}

TEST(SubmapSearch, FindsTheBestPlaceThatTryingAllFinds) {
  Plan plan;
  for (const auto& [x, y] : {std::pair{3.0, 7.0}, {6.5, 2.0}, {11.0, 9.0}, {14.2, 4.4}, {17.0, 8.0}}) {
    plan.Fill(x, y, x + 0.3, y + 0.3);
  }
  // Four of the five pillars, one of them in the wrong place: three hit.
  const std::vector<base::Point> seen{{3.15, 7.15}, {6.65, 2.15}, {11.15, 9.15}, {9.0, 5.0}};
  const auto matches = plan.Search().Find(seen, {});
  ASSERT_GE(matches.size(), 1U);
  EXPECT_EQ(matches[0].share, 0.75);
  EXPECT_NEAR(matches[0].pose.x, 0.0, 0.4);
  EXPECT_NEAR(matches[0].pose.y, 0.0, 0.4);
}

TEST(SubmapSearch, RefusesPointsAndLimitsThatCannotBe) {
  const Plan plan;
  const SubmapSearch search = plan.Search();
  EXPECT_THROW(search.Find({{0.0, 0.0}, {3000.0, 0.0}}, {}), std::invalid_argument);
  EXPECT_THROW(search.Find({{std::nan(""), 0.0}}, {}), std::invalid_argument);
  SubmapSearch::Limits limits;
  limits.distinct_m = 0.0;
  EXPECT_THROW(search.Find({{0.0, 0.0}}, limits), std::invalid_argument);
  EXPECT_THROW(SubmapSearch({{0.0, 0.0}, 0.1, 1, 1}, {0}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
