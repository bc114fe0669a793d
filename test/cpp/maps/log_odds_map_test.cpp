#include "robotteamsim/maps/log_odds_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "rooms.hpp"

namespace robotteamsim::maps {
namespace {

constexpr double kCell = 0.5;

/// A beam that ends in the cell (6, 0), from (0, 0): it crosses six cells before.
const Scan kOneHit{{0.25, 0.25}, {{{3.25, 0.3}, {-1.0, 0.0}}}, {}};

TEST(LogOddsMap, IsFreeAlongABeamAndOccupiedAtItsEnd) {
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {});
  for (int col = 0; col < 6; ++col) EXPECT_EQ(map.LogOdds({col, 0}), LogOddsMap::kMiss) << col;
  EXPECT_EQ(map.LogOdds({6, 0}), LogOddsMap::kHit);
  EXPECT_EQ(map.LogOdds({7, 0}), 0);
  EXPECT_EQ(map.LogOdds({3, 1}), 0);
}

TEST(LogOddsMap, InsertsAScanAtAPose) {
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {-100.0, 40.0, std::acos(0.0)});  // upwards, from (-100.25, 40.25) to (-100.3, 43.25)
  EXPECT_EQ(map.LogOdds({-201, 86}), LogOddsMap::kHit);
  EXPECT_EQ(map.LogOdds({-201, 81}), LogOddsMap::kMiss);
}

TEST(LogOddsMap, HasTheMeanOfTheHitsInACell) {
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {});
  map.Insert({{0.25, 0.25}, {{{3.35, 0.1}, {-1.0, 0.0}}}, {}}, {});
  const std::vector<HitCell> hits = map.Hits();
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(hits[0].count, 2);
  EXPECT_NEAR(hits[0].mean.at.x, 3.3, 1e-12);
  EXPECT_NEAR(hits[0].mean.at.y, 0.2, 1e-12);
}

TEST(LogOddsMap, BelievesAHitMoreThanABeamOfTheSameScanThatCrossesItsCell) {
  LogOddsMap map(kCell);
  map.Insert({{0.25, 0.25}, {{{3.25, 0.3}, {}}, {{5.25, 0.35}, {}}}, {}}, {});
  EXPECT_EQ(map.LogOdds({6, 0}), LogOddsMap::kHit);
  EXPECT_EQ(map.LogOdds({10, 0}), LogOddsMap::kHit);
}

TEST(LogOddsMap, ForgetsADoorThatHasOpened) {
  LogOddsMap map(kCell);
  for (int i = 0; i < 100; ++i) map.Insert(kOneHit, {});
  for (int i = 0; i < 13; ++i) map.Insert({{0.25, 0.25}, {}, {{5.25, 0.25}}}, {});  // 96 / 8 = 12 misses
  EXPECT_LT(map.LogOdds({6, 0}), 0);
  EXPECT_TRUE(map.Hits().empty());
}

TEST(LogOddsMap, CountsTheCellsThatAScanChanges) {
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {});
  EXPECT_EQ(map.changes(), 7U);
  map.Insert(kOneHit, {});
  EXPECT_EQ(map.changes(), 7U);
}

TEST(LogOddsMap, IsOccupiedInACoarserCellIfAnyPartIs) {
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {-1.0, 0.0, 0.0});  // free from cell -2, occupied in cell 4
  const OccupancyGrid grid = map.Occupancy({{-3, 0}, {5, 1}}, 2);
  EXPECT_EQ(grid.shape.origin.x, -2.0);
  EXPECT_EQ(grid.shape.resolution_m, 1.0);
  EXPECT_EQ(grid.cells, (std::vector<std::int8_t>{kUnknown, kFree, kFree, kFree, kOccupied}));
  EXPECT_EQ(map.Occupancy({{-3, 0}, {5, 1}}, std::numeric_limits<int>::max()).cells,
            (std::vector<std::int8_t>{kFree, kOccupied}));
  EXPECT_THROW(map.Occupancy({}, 0), std::invalid_argument);
}

TEST(LogOddsMap, KnowsWhereItHasChanged) {
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {});
  EXPECT_EQ(map.changed().low.col, 0);
  EXPECT_EQ(map.changed().high.col, 6);
  map.ForgetChanged();
  EXPECT_TRUE(map.changed().IsEmpty());
  map.Insert(kOneHit, {-100.0, 40.0, 0.0});
  EXPECT_EQ(map.changed().high.col, -194);
  EXPECT_EQ(map.changed().low.row, 80);
  EXPECT_EQ(map.changed().high.row, 80);
}

TEST(LogOddsMap, InsertsAScanOfAnotherGridWhoseCellsCoincide) {
  const base::Pose pose{7.3, -3.1, 0.5};
  const Scan scan = ScanIn(Rectangle(-2.0, -1.0, 12.0, 1.0), {});
  LogOddsMap map(0.05), shifted(0.05);
  map.Insert(scan, pose);
  shifted.InsertCells(CellsOfScan(scan, pose, 0.05), {130, -70});
  const std::vector<HitCell> hits = map.Hits(), others = shifted.Hits();
  ASSERT_EQ(others.size(), hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_EQ(others[i].count, hits[i].count);
    EXPECT_NEAR(others[i].mean.at.x + 130 * 0.05, hits[i].mean.at.x, 1e-9);
    EXPECT_NEAR(others[i].mean.at.y - 70 * 0.05, hits[i].mean.at.y, 1e-9);
  }
  int differ = 0;
  for (int row = -300; row < 200; ++row) {
    for (int col = 0; col < 500; ++col) {
      differ += map.LogOdds({col, row}) != shifted.LogOdds({col - 130, row + 70}) ? 1 : 0;
    }
  }
  EXPECT_EQ(differ, 0);
}

TEST(LogOddsMap, KnowsARoomAndNothingBeyondItsWalls) {
  LogOddsMap map(0.05);
  map.Insert(ScanIn(Rectangle(-2.0, -1.0, 2.0, 1.0), {}), {});
  const OccupancyGrid grid = Cropped(map.Occupancy());
  EXPECT_NEAR(grid.shape.cols * 0.05, 4.0, 0.11);
  EXPECT_NEAR(grid.shape.rows * 0.05, 2.0, 0.11);
}

TEST(LogOddsMap, TakesOverWhatAnotherMapKnows) {
  const Scan scan = ScanIn(Rectangle(-2.0, -1.0, 2.0, 1.0), {});
  const base::Pose pose{7.0, -3.0, 0.5};
  LogOddsMap other(0.05), map(0.05), direct(0.05);
  other.Insert(scan, {});
  map.AddFree(other.Occupancy(), pose);
  map.AddHits(other.Hits(), pose);
  direct.Insert(scan, pose);
  // Cells of two grids that are turned differ along borders.
  int differ = 0, known = 0;
  for (int row = -100; row < 0; ++row) {
    for (int col = 80; col < 200; ++col) {
      const int copied = map.LogOdds({col, row}), seen = direct.LogOdds({col, row});
      known += seen != 0 ? 1 : 0;
      differ += (seen > 0) != (copied > 0) || (seen == 0) != (copied == 0) ? 1 : 0;
    }
  }
  EXPECT_GT(known, 1000);
  EXPECT_LT(differ, known / 4);
}

TEST(LogOddsMap, RefusesWhatItCannotHold) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(LogOddsMap(0.0), std::invalid_argument);
  EXPECT_THROW(LogOddsMap{nan}, std::invalid_argument);
  LogOddsMap map(kCell);
  map.Insert(kOneHit, {});
  EXPECT_THROW(map.Insert(kOneHit, {1e7, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(map.Insert(kOneHit, {5e5, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(map.Insert(kOneHit, {nan, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(map.Insert({{0.0, 0.0}, {}, {{101.0, 0.0}}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
