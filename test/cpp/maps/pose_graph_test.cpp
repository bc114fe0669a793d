#include "robotteamsim/maps/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robotteamsim::maps {
namespace {

const Eigen::Matrix3d kUnit = Eigen::Matrix3d::Identity();

TEST(PoseGraph, WeighsTwoMeasurementsByTheirInformation) {
  PoseGraph graph;
  graph.Add({1.0, 2.0, 0.0});
  graph.Add({0.0, 0.0, 0.0});
  graph.Connect({0, 1, {1.0, 0.0, 0.2}, kUnit});
  graph.Connect({0, 1, {2.0, 4.0, 0.6}, 3.0 * kUnit});
  graph.Optimise();
  EXPECT_NEAR(graph.poses()[1].x, 1.0 + 1.75, 1e-5);  // (1 + 3 * 2) / 4
  EXPECT_NEAR(graph.poses()[1].y, 2.0 + 3.0, 1e-5);
  EXPECT_NEAR(graph.poses()[1].yaw, 0.5, 1e-5);
  EXPECT_EQ(graph.poses()[0].x, 1.0);
  EXPECT_NEAR(graph.Errors()[0], 0.75 * 0.75 + 3.0 * 3.0 + 0.3 * 0.3, 1e-4);
}

TEST(PoseGraph, ClosesASquareWhoseTurnsWereMeasuredTooLarge) {
  const double right_angle = std::acos(0.0);
  PoseGraph graph;
  base::Pose pose;
  graph.Add(pose);
  for (std::size_t i = 0; i < 4; ++i) {
    const base::Pose motion{1.0, 0.0, right_angle + 0.05};
    pose = base::Composed(pose, motion);
    graph.Add(pose);
    graph.Connect({i, i + 1, motion, kUnit});
  }
  EXPECT_GT(std::hypot(pose.x, pose.y), 0.1);
  graph.Connect({4, 0, {}, 1e6 * kUnit});
  graph.Optimise();
  EXPECT_NEAR(graph.poses()[4].x, 0.0, 1e-3);
  EXPECT_NEAR(graph.poses()[2].x, 1.0, 0.03);
  EXPECT_NEAR(graph.poses()[2].y, 1.0, 0.03);
  EXPECT_NEAR(graph.poses()[1].yaw, right_angle, 0.03);
}

TEST(PoseGraph, StaysWhereAllMeasurementsAgree) {
  PoseGraph graph;
  const std::vector<base::Pose> poses{{0.0, 0.0, 0.0}, {2.0, 1.0, 1.5}, {-3.0, 0.5, 3.0}};
  for (const base::Pose& pose : poses) graph.Add(pose);
  for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {2, 0}}) {
    graph.Connect({from, to, base::RelativePose(poses[from], poses[to]), kUnit});
  }
  graph.Optimise();
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_NEAR(graph.poses()[i].x, poses[i].x, 1e-12);
}

TEST(PoseGraph, LeavesAPoseThatNothingMeasures) {
  PoseGraph graph;
  graph.Add({});
  graph.Add({5.0, 6.0, 0.7});
  graph.Optimise();
  EXPECT_EQ(graph.poses()[1].x, 5.0);
}

TEST(PoseGraph, RefusesMeasurementsOfOtherPosesAndNumbers) {
  PoseGraph graph;
  graph.Add({});
  graph.Add({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(graph.Connect({0, 2, {}, kUnit}), std::invalid_argument);
  EXPECT_THROW(graph.Connect({1, 1, {}, kUnit}), std::invalid_argument);
  EXPECT_THROW(graph.Connect({0, 1, {nan, 0.0, 0.0}, kUnit}), std::invalid_argument);
  EXPECT_THROW(graph.Connect({0, 1, {}, nan * kUnit}), std::invalid_argument);
  EXPECT_THROW(graph.Add({nan, 0.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
