#include "robotteamsim/propagation/maps/wall_shadows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <vector>

#include "../reference.hpp"
#include "../scenes.hpp"

namespace robotteamsim::propagation {
namespace {

/// Sums up the changes in columns [first, last), some rows at a time, and compares with one ray per cell.
void ExpectWeights(const FaceSet& faces, PointMm source, const CellCentersMm& cells, IndexRange cols,
                   int rows_at_once) {
  const int width = cols.last - cols.first;
  const WallShadows shadows(faces, source, cells);
  ShadowSweep sweep(shadows, cols);
  std::vector<std::int32_t> weights(width, 0);
  for (int row = 0; row < cells.y.Count(); row += rows_at_once) {
    const IndexRange rows{row, std::min(row + rows_at_once, cells.y.Count())};
    std::vector<std::int32_t> changes(static_cast<std::size_t>(width) * rows_at_once, 0);
    sweep.AddChanges(rows, changes.data(), width);
    for (int i = 0; i < rows.last - row; ++i) {
      for (int col = 0; col < width; ++col) {
        weights[col] += changes[i * width + col];
        ASSERT_EQ(weights[col], reference::Weight(faces, source, cells, row + i, cols.first + col))
            << "source " << source.x << " " << source.y << " row " << row + i << " col " << cols.first + col;
      }
    }
  }
}

TEST(WallShadows, EqualOneRayPerCellOnALattice) {
  std::mt19937 generator(1);
  for (int plan = 0; plan < 5000; ++plan) {
    const FaceSet faces = scenes::Lattice(&generator, 1 + plan % 12, 14, 9);
    // Sources on, beside and outside the lattice; cells at every point of it or every other.
    const PointMm source{scenes::Draw(&generator, -3, 16), scenes::Draw(&generator, -3, 16)};
    const plan::GridShape grid{{-0.003, -0.004}, plan % 2 == 0 ? 0.001 : 0.002, 20, 21};
    ExpectWeights(faces, source, CellCentersMm(grid), {0, 21}, 1 + plan % 21);
  }
}

TEST(WallShadows, EqualOneRayPerCellFromEveryVertex) {
  std::mt19937 generator(2);
  for (int plan = 0; plan < 40; ++plan) {
    const FaceSet faces = scenes::Lattice(&generator, 8, 10, 9);
    for (const PointMm& vertex : faces.Vertices()) {
      ExpectWeights(faces, vertex, CellCentersMm({{-0.001, -0.001}, 0.001, 12, 12}), {0, 12}, 5);
    }
  }
}

TEST(WallShadows, EqualOneRayPerCellInBuildings) {
  std::mt19937 generator(3);
  for (int plan = 0; plan < 60; ++plan) {
    const FaceSet faces = scenes::Walls(&generator, 2 + plan, plan % 3 * 50);
    const PointMm source{scenes::Draw(&generator, -5000, 65'000), scenes::Draw(&generator, -5000, 45'000)};
    const plan::GridShape grid{{static_cast<double>(scenes::Draw(&generator, -3000, 3000)) / 1000.0, -1.0},
                               static_cast<double>(scenes::Draw(&generator, 100, 900)) / 1000.0,
                               60,
                               90};
    ExpectWeights(faces, source, CellCentersMm(grid), {0, 90}, 17);
  }
}

TEST(WallShadows, EqualOneRayPerCellWhereTheResolutionIsNotAWholeMillimetre) {
  std::mt19937 generator(4);
  for (int plan = 0; plan < 20; ++plan) {
    const FaceSet faces = scenes::Walls(&generator, 20, 50);
    ExpectWeights(faces, {30'000, 20'000}, CellCentersMm({{0.0, 0.0}, 0.6667, 60, 90}), {0, 90}, 13);
  }
}

TEST(WallShadows, EqualOneRayPerCellInAnyPartOfTheColumns) {
  std::mt19937 generator(5);
  for (int plan = 0; plan < 20; ++plan) {
    const FaceSet faces = scenes::Walls(&generator, 20, 50);
    const CellCentersMm cells({{0.0, 0.0}, plan % 2 == 0 ? 0.5 : 0.6667, 80, 120});
    ExpectWeights(faces, {22'250, 15'250}, cells, {0, 37}, 80);
    ExpectWeights(faces, {22'250, 15'250}, cells, {37, 120}, 10);
  }
}

TEST(WallShadows, AreExactAtTheLimitOfCoordinates) {
  const std::int64_t far = kMaxCoordinateMm;
  const FaceSet faces({{-far, -far, far, far}, {-far, far, far, -far + 1}, {0, -far, 1, far}}, {1, 2, 4});
  for (const PointMm source : {PointMm{far, far - 1}, PointMm{-far, -far}, PointMm{7, -9}}) {
    ExpectWeights(faces, source, CellCentersMm({{-1e6, -1e6}, 1e5, 20, 20}), {0, 20}, 20);
    ExpectWeights(faces, source, CellCentersMm({{-0.01, -0.01}, 0.001, 20, 20}), {0, 20}, 7);
  }
}

TEST(WallShadows, IgnoreFacesThatAreNotActive) {
  std::mt19937 generator(6);
  FaceSet faces = scenes::Walls(&generator, 10, 50);
  for (std::size_t i = 0; i < faces.Size(); i += 3) faces.SetActive(i, false);
  ExpectWeights(faces, {30'000, 20'000}, CellCentersMm({{0.0, 0.0}, 1.0, 40, 60}), {0, 60}, 40);
}

TEST(WallShadows, RefuseWeightsWhoseSumsCouldOverflow) {
  const FaceSet faces({{0, 0, 1, 0}, {0, 0, 0, 1}}, {300'000'000, 300'000'000});
  EXPECT_THROW(WallShadows(faces, {5, 5}, CellCentersMm({{0.0, 0.0}, 1.0, 4, 4})), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::propagation
