#include "robotteamsim/propagation/radio.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "scenes.hpp"

namespace robotteamsim::propagation {
namespace {

const RadioModel kModel{0.0, 47.4, 23.2, 0.1, 18.3, 0.46};

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

TEST(PathLoss, IsTheSameBothWaysToTheBitInRandomBuildingsAndOnALattice) {
  std::mt19937 generator(1);
  for (int plan = 0; plan < 20; ++plan) {
    const FaceSet walls = scenes::Walls(&generator, 40, 50);
    const FaceSet triangles = scenes::Lattice(&generator, 12, 9, 9);
    for (int pair = 0; pair < 1000; ++pair) {
      const PointMm a{scenes::Draw(&generator, 0, 60'000), scenes::Draw(&generator, 0, 40'000)};
      const PointMm b{scenes::Draw(&generator, 0, 60'000), scenes::Draw(&generator, 0, 40'000)};
      ASSERT_EQ(PathLossDb(walls, kModel, a, b), PathLossDb(walls, kModel, b, a));
      const PointMm c{a.x % 10, a.y % 10};
      const PointMm d{b.x % 10, b.y % 10};
      ASSERT_EQ(PathLossDb(triangles, kModel, c, d), PathLossDb(triangles, kModel, d, c));
    }
  }
}

TEST(RssiMatrix, IsSymmetricWithZeroDiagonal) {
  Positions positions(3, 2);
  positions << 0.0, 0.0, 10.0, 0.0, 2.0, 3.0;
  const CellValues rssi_dbm = RssiMatrixDbm(Wall(), kModel, positions);
  EXPECT_EQ(rssi_dbm, rssi_dbm.transpose());
  EXPECT_EQ(rssi_dbm.diagonal().cwiseAbs().sum(), 0.0);
  EXPECT_DOUBLE_EQ(rssi_dbm(0, 1), -(47.4 + 23.2 + 3.8));
}

TEST(RssiMatrix, IsPathLossOfEachLinkToTheBitWithAnyInstructionSet) {
  std::mt19937 generator(21);
  for (const int n : {0, 1, 2, 5, 9, 31, 32, 33, 64, 100}) {
    const FaceSet faces = scenes::Walls(&generator, 30, 30);
    RadioModel model = kModel;
    model.tx_power_dbm = 12.3;
    Positions positions(n, 2);
    for (int i = 0; i < n; ++i) {
      positions(i, 0) = static_cast<double>(scenes::Draw(&generator, 0, 60'000)) / 1000.0;
      positions(i, 1) = static_cast<double>(scenes::Draw(&generator, 0, 40'000)) / 1000.0;
    }
    if (n > 2) positions.row(2) = positions.row(0);
    for (const base::Simd simd : {base::Simd::kPortable, base::Simd::kAvx2, base::Simd::kAvx512}) {
      if (!base::IsSupported(simd)) continue;
      const CellValues rssi_dbm = RssiMatrixDbm(faces, model, positions, simd);
      ASSERT_EQ(rssi_dbm.rows(), n);
      for (int i = 0; i < n; ++i) {
        const PointMm a = RoundToMm({positions(i, 0), positions(i, 1)}, "a");
        for (int j = 0; j < n; ++j) {
          const PointMm b = RoundToMm({positions(j, 0), positions(j, 1)}, "b");
          ASSERT_EQ(rssi_dbm(i, j), i == j ? 0.0 : model.tx_power_dbm - PathLossDb(faces, model, a, b));
        }
      }
    }
  }
}

TEST(RssiMatrix, IsTheSameInMemoryOfTheCallerWhateverIsThere) {
  std::mt19937 generator(22);
  const FaceSet faces = scenes::Walls(&generator, 30, 30);
  CellValues kept = CellValues::Constant(70, 70, 5.0);
  for (int team = 0; team < 2; ++team) {
    Positions positions(70, 2);
    for (Eigen::Index i = 0; i < positions.size(); ++i) {
      positions(i / 2, i % 2) = static_cast<double>(scenes::Draw(&generator, 0, 40'000)) / 1000.0;
    }
    WriteRssiMatrixDbm(faces, kModel, positions, kept);
    EXPECT_EQ(kept, RssiMatrixDbm(faces, kModel, positions));
    EXPECT_THROW(WriteRssiMatrixDbm(faces, kModel, positions, kept.leftCols(69)), std::invalid_argument);
    EXPECT_THROW(WriteRssiMatrixDbm(faces, kModel, positions, kept.topRows(69)), std::invalid_argument);
  }
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

TEST(FloorLoss, IsTheLastTermOfEquation4) {
  // COST 231: b = 0.46, 18.3 dB for the first floor; then 2^(4/3 - 0.46) = 1.832 and 3^(5/4 - 0.46) = 2.382 times that.
  EXPECT_EQ(FloorLossDb(kModel, 0), 0.0);
  EXPECT_DOUBLE_EQ(FloorLossDb(kModel, 1), 18.3);
  EXPECT_NEAR(FloorLossDb(kModel, 2), 1.832 * 18.3, 0.01);
  EXPECT_NEAR(FloorLossDb(kModel, 3), 2.382 * 18.3, 0.01);
  EXPECT_DOUBLE_EQ(PathLossDb(Wall(), kModel, {0, 0}, {10000, 0}, 1), 47.4 + 23.2 + 3.8 + 18.3);
  EXPECT_THROW(FloorLossDb(kModel, -1), std::invalid_argument);
}

TEST(RadioFading, IsTheSignalOfPathLoss) {
  RadioModel model = kModel;
  model.tx_power_dbm = 12.0;
  const plan::GridShape grid{{-1.0, -2.0}, 0.25, 16, 40};
  for (const int floors_crossed : {0, 2}) {
    MapValues rssi_dbm(grid.rows, grid.cols);
    WriteHighest(Wall(), {{{125, 125}, RadioFading(model, floors_crossed)}}, grid, rssi_dbm);
    for (int row = 0; row < grid.rows; ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        const PointMm cell = RoundToMm(CellCenter(grid, row, col), "cell");
        ASSERT_NEAR(rssi_dbm(row, col), 12.0 - PathLossDb(Wall(), model, {125, 125}, cell, floors_crossed), 4e-5);
      }
    }
  }
}

TEST(RadioSources, AreTheTransmittersInMillimetresWithTheFadingOfTheirSignal) {
  const std::vector<FieldSource> sources = RadioSources(kModel, {{1.0, 2.0}, {-0.0015, 3.0}}, 1);
  ASSERT_EQ(sources.size(), 2U);
  EXPECT_EQ(sources[0].position.x, 1000);
  EXPECT_EQ(sources[0].position.y, 2000);
  EXPECT_EQ(sources[1].position.x, -2);
  EXPECT_DOUBLE_EQ(sources[1].fading.constant_db, -47.4 - 18.3);
  EXPECT_DOUBLE_EQ(sources[1].fading.slope_db, 23.2);
  EXPECT_THROW(RadioSources(kModel, {{1.0, 2.0}, {2e6, 0.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::propagation
