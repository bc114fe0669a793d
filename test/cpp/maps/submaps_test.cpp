#include "robotteamsim/maps/submaps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rooms.hpp"

namespace robotteamsim::maps {
namespace {

const MatcherParameters kParameters{0.3, 0.07, 0.02, 0.03};

/// Four rooms in a square, 4 m wide, with doors of 1 m between them: thin walls that are seen from both sides.
Walls FourRooms() {
  Walls walls = Rectangle(0.0, 0.0, 8.0, 8.0);
  for (const auto& [from, to] : {std::pair{0.0, 1.5}, {2.5, 5.5}, {6.5, 8.0}}) {
    for (const double side : {3.95, 4.05}) {
      walls.push_back({{side, from}, {side, to}});
      walls.push_back({{from, side}, {to, side}});
    }
  }
  return walls;
}

/// The first poses of submaps on a lap through the rooms and into the first one again.
const std::vector<base::Pose> kTruth{{1.0, 2.0, 0.0}, {3.0, 2.0, 0.0}, {6.0, 2.0, 0.0}, {6.0, 6.0, 0.0},
                                     {3.0, 6.0, 0.0}, {2.0, 5.0, 0.0}, {2.0, 3.0, 0.0}, {2.2, 1.5, 0.0}};

/// A submap of scans around a pose, in the frame of that pose.
LogOddsMap SubmapAt(const base::Pose& pose) {
  LogOddsMap map(0.05);
  for (const double dx : {-0.4, 0.0, 0.4}) {
    const base::Pose offset{dx, 0.2 * dx, dx};
    map.Insert(ScanIn(FourRooms(), base::Composed(pose, offset), 5.0), offset);
  }
  return map;
}

struct Lap {
  Submaps submaps;
  double drift_m;  ///< how wrong the last pose would be without loops
};

/// The submaps of a robot whose poses drift a bit farther with each one.
Lap Driven(const base::Pose& drift_a_submap) {
  Lap lap{Submaps(kParameters), 0.0};
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-3, 1e-3, 1e-4).asDiagonal();
  base::Pose believed = kTruth[0], uncorrected = kTruth[0];
  for (std::size_t i = 0; i < kTruth.size(); ++i) {
    if (i > 0) {
      const base::Pose motion = base::Composed(base::RelativePose(kTruth[i - 1], kTruth[i]), drift_a_submap);
      believed = base::Composed(believed, motion);
      uncorrected = base::Composed(uncorrected, motion);
    }
    if (lap.submaps.Add(SubmapAt(kTruth[i]), believed, covariance)) believed = lap.submaps.poses().back();
  }
  lap.drift_m = std::hypot(uncorrected.x - kTruth.back().x, uncorrected.y - kTruth.back().y);
  return lap;
}

double WorstError(const Submaps& submaps) {
  double worst = 0.0;
  for (std::size_t i = 0; i < kTruth.size(); ++i) {
    worst = std::max(worst, std::hypot(submaps.poses()[i].x - kTruth[i].x, submaps.poses()[i].y - kTruth[i].y));
  }
  return worst;
}

TEST(Submaps, OfARightMapAreNotMovedByLoops) { EXPECT_LT(WorstError(Driven({}).submaps), 0.01); }

TEST(Submaps, MoveToCloseALoop) {
  const Lap lap = Driven({0.02, 0.0, 0.006});
  EXPECT_GT(lap.drift_m, 0.1);
  EXPECT_LT(WorstError(lap.submaps), 0.5 * lap.drift_m);
}

TEST(Submaps, AreKeptAsRunLengths) {
  Submaps submaps(kParameters);
  const LogOddsMap map = SubmapAt(kTruth[0]);
  EXPECT_FALSE(submaps.Add(map, kTruth[0], Eigen::Matrix3d::Identity()));
  EXPECT_EQ(submaps.at(0).Grid().cells, Cropped(map.Occupancy()).cells);
  EXPECT_LT(submaps.Bytes(), map.Bytes() / 2);
}

}  // namespace
}  // namespace robotteamsim::maps
