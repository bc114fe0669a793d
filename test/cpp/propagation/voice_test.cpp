#include "robotteamsim/propagation/voice.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace robotteamsim::propagation {
namespace {

const VoiceModel kModel{10.0, 1.0, 0.1};

/// A wall across x = 5 m, 1 half wall per face.
FaceSet Wall() { return FaceSet({{4900, -9000, 4900, 9000}, {5100, -9000, 5100, 9000}}, {1, 1}); }

TEST(VoiceLevel, IsTheConstantAtOneMetre) {
  EXPECT_DOUBLE_EQ(VoiceLevelDb(Wall(), kModel, {{0.0, 0.0}, -78.0, 5.0}, {1000, 0}), 78.0);
}

TEST(VoiceLevel, FallsByTheExponentAndTheWalls) {
  EXPECT_DOUBLE_EQ(VoiceLevelDb(Wall(), kModel, {{0.0, 0.0}, -78.0, 5.0}, {10000, 0}), 78.0 - 50.0 - 2.0);
  EXPECT_DOUBLE_EQ(VoiceLevelDb(Wall(), kModel, {{5.0, 0.0}, -78.0, 5.0}, {6000, 0}), 78.0 - 1.0);
}

MapValues VoiceMap(const FaceSet& faces, const std::vector<VoiceSource>& sources, const plan::GridShape& grid,
                   const SolidCells& solid) {
  MapValues map = MapValues::Constant(grid.rows, grid.cols, -1.0F);
  WriteVoiceMap(faces, kModel, sources, grid, solid, map);
  return map;
}

TEST(VoiceMap, KeepsTheHighestVoiceAndDropsWhatIsBelowTheNoise) {
  const plan::GridShape grid{{0.0, 0.0}, 0.5, 1, 80};
  const SolidCells solid = SolidCells::Constant(1, 80, false);
  const std::vector<VoiceSource> sources = {{{1.0, 0.25}, -78.0, 5.0}, {{12.0, 0.25}, -72.0, 6.0}};
  const MapValues map = VoiceMap(Wall(), sources, grid, solid);
  for (int col = 0; col < grid.cols; ++col) {
    const PointMm cell = RoundToMm(CellCenter(grid, 0, col), "cell");
    const double best =
        std::max(VoiceLevelDb(Wall(), kModel, sources[0], cell), VoiceLevelDb(Wall(), kModel, sources[1], cell));
    ASSERT_NEAR(map(0, col), best >= 10.0 ? best : 0.0, 5e-5) << col;
  }
  EXPECT_EQ(map(0, 79), 0.0F);
}

TEST(VoiceMap, GivesNoVoiceToSolidCells) {
  SolidCells solid = SolidCells::Constant(3, 4, false);
  solid(2, 1) = true;
  const MapValues map = VoiceMap(FaceSet({}, {}), {{{0.5, 0.5}, -78.0, 5.0}}, {{0.0, 0.0}, 0.25, 3, 4}, solid);
  EXPECT_EQ(map(2, 1), 0.0F);
  EXPECT_EQ((map.array() > 0.0F).count(), 11);
}

TEST(VoiceMap, IsSilentWithoutSources) {
  const SolidCells solid = SolidCells::Constant(3, 4, false);
  EXPECT_EQ(VoiceMap(Wall(), {}, {{0.0, 0.0}, 0.25, 3, 4}, solid), MapValues::Zero(3, 4));
}

TEST(VoiceMap, RefusesSolidCellsOrAMapOfAnotherShape) {
  const plan::GridShape grid{{0.0, 0.0}, 0.25, 3, 4};
  MapValues map(3, 4);
  MapValues turned(4, 3);
  EXPECT_THROW(WriteVoiceMap(Wall(), kModel, {}, grid, SolidCells::Constant(4, 3, false), map), std::invalid_argument);
  EXPECT_THROW(WriteVoiceMap(Wall(), kModel, {}, grid, SolidCells::Constant(3, 4, false), turned),
               std::invalid_argument);
}

TEST(LoudestCell, IsWithinTheRadius) {
  const plan::GridShape grid{{0.0, 0.0}, 1.0, 5, 5};
  MapValues values = MapValues::Constant(5, 5, 1.0F);
  values(2, 2) = 2.0F;  // centre (2.5, 2.5)
  values(4, 4) = 9.0F;
  const std::optional<Cell> best = LoudestCell(grid, values, {1.5, 2.5}, 1.0);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->row, 2);
  EXPECT_EQ(best->col, 2);
  EXPECT_EQ(best->value, 2.0);
}

TEST(LoudestCell, PrefersTheLowestRowThenColumn) {
  const plan::GridShape grid{{0.0, 0.0}, 1.0, 5, 5};
  const std::optional<Cell> best = LoudestCell(grid, MapValues::Constant(5, 5, 1.0F), {2.5, 2.5}, 1.5);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->row, 1);
  EXPECT_EQ(best->col, 1);
}

TEST(LoudestCell, IsTheSameWhateverTheGuess) {
  const plan::GridShape grid{{0.0, 0.0}, 1.0, 5, 5};
  MapValues values = MapValues::Constant(5, 5, 1.0F);
  values(3, 2) = values(2, 3) = 2.0F;
  for (int row = 0; row < 5; ++row) {
    for (int col = 0; col < 5; ++col) {
      const std::optional<Cell> best = LoudestCell(grid, values, {2.5, 2.5}, 1.5, Cell{row, col, 0.0});
      ASSERT_TRUE(best);
      EXPECT_EQ(best->row, 2);
      EXPECT_EQ(best->col, 3);
      EXPECT_EQ(best->value, 2.0);
    }
  }
}

TEST(LoudestCell, IsNothingWhereAllIsSilentOrFar) {
  const plan::GridShape grid{{0.0, 0.0}, 1.0, 5, 5};
  EXPECT_FALSE(LoudestCell(grid, MapValues::Zero(5, 5), {2.5, 2.5}, 2.0));
  EXPECT_FALSE(LoudestCell(grid, MapValues::Ones(5, 5), {-50.0, 2.5}, 2.0));
  EXPECT_FALSE(LoudestCell(grid, MapValues::Ones(5, 5), {2.5, 1e30}, 2.0));
}

}  // namespace
}  // namespace robotteamsim::propagation
