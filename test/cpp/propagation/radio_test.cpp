#include "robotteamsim/propagation/radio.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace robotteamsim {
namespace {

const RadioModel kModel{0.0, 47.4, 23.2, 0.1};

/// A wall across x = 5 m of 3.8 dB: 38 units of 0.05 dB per face.
FaceSet Wall() { return FaceSet({{4900, -9000, 4900, 9000}, {5100, -9000, 5100, 9000}}, {38, 38}); }

TEST(PathLoss, IsTheOneSlopeModelWithoutWalls) {
  const FaceSet nothing({}, {});
  EXPECT_DOUBLE_EQ(PathLossDb(nothing, kModel, {0, 0}, {1000, 0}), 47.4);
  EXPECT_DOUBLE_EQ(PathLossDb(nothing, kModel, {0, 0}, {6000, 8000}), 47.4 + 23.2);
}

TEST(PathLoss, AddsTheWall) { EXPECT_DOUBLE_EQ(PathLossDb(Wall(), kModel, {0, 0}, {10000, 0}), 47.4 + 23.2 + 3.8); }

TEST(PathLoss, CountsDistancesBelowTheLimitAsTheLimit) {
  EXPECT_DOUBLE_EQ(PathLossDb(Wall(), kModel, {0, 0}, {0, 0}), 47.4 - 23.2);
  EXPECT_DOUBLE_EQ(PathLossDb(Wall(), kModel, {0, 0}, {99, 0}), 47.4 - 23.2);
}

TEST(RssiMatrix, IsSymmetricWithZeroDiagonal) {
  Positions positions(3, 2);
  positions << 0.0, 0.0, 10.0, 0.0, 2.0, 3.0;
  const CellValues rssi_dbm = RssiMatrixDbm(Wall(), kModel, positions);
  EXPECT_EQ(rssi_dbm, rssi_dbm.transpose());
  EXPECT_EQ(rssi_dbm.diagonal().cwiseAbs().sum(), 0.0);
  EXPECT_DOUBLE_EQ(rssi_dbm(0, 1), -(47.4 + 23.2 + 3.8));
}

TEST(RssiMatrix, NamesTheRobotWhosePositionIsNotFinite) {
  Positions positions(2, 2);
  positions << 0.0, 0.0, std::nan(""), 1.0;
  try {
    RssiMatrixDbm(Wall(), kModel, positions);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "position of robot 1 must be finite and within 1000 km, got (nan, 1)");
  }
}

TEST(RssiMap, EqualsPathLossAtEveryCell) {
  const GridShape grid{{-1.0, -2.0}, 0.25, 16, 40};
  const CellValues rssi_dbm = RssiMapDbm(Wall(), kModel, {125, 125}, grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const PointMm cell = RoundToMm(CellCenter(grid, row, col), "cell");
      ASSERT_EQ(rssi_dbm(row, col), -PathLossDb(Wall(), kModel, {125, 125}, cell)) << row << " " << col;
    }
  }
}

TEST(RssiMap, RefusesAGridWithoutCells) {
  EXPECT_THROW(RssiMapDbm(Wall(), kModel, {0, 0}, {{0.0, 0.0}, 0.0, 4, 4}), std::invalid_argument);
  EXPECT_THROW(RssiMapDbm(Wall(), kModel, {0, 0}, {{0.0, 0.0}, 0.1, 0, 4}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim
