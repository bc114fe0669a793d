#include "robotteamsim/propagation/maps/field_maps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>
#include <vector>

#include "../reference.hpp"
#include "../scenes.hpp"

namespace robotteamsim::propagation {
namespace {

const Fading kRadio{-47.4, 23.2, 0.05, 0.1};
const Fading kVoice{78.0, 60.0, 1.0, 0.1};
const plan::GridShape kGrid{{0.0, 0.0}, 0.25, 160, 240};

/// What floats leave of the logarithm, as long as values are within 128 dB of 0 (half a float's last bit is 4e-6
/// there).
constexpr double kRadioErrorDb = 2.5e-5;
constexpr double kVoiceErrorDb = 4e-5;

std::vector<base::Simd> Supported() {
  std::vector<base::Simd> all;
  for (const base::Simd simd : {base::Simd::kPortable, base::Simd::kAvx2, base::Simd::kAvx512}) {
    if (base::IsSupported(simd)) all.push_back(simd);
  }
  return all;
}

MapValues Highest(const FaceSet& faces, const std::vector<FieldSource>& sources, const plan::GridShape& grid,
                  const MapWork& work = {}) {
  MapValues map = MapValues::Constant(grid.rows, grid.cols, std::nanf(""));
  WriteHighest(faces, sources, grid, map, work);
  return map;
}

bool SameBits(const MapValues& a, const MapValues& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(FieldMap, IsTheHandWorkedValue) {
  // 10 m behind a wall of 3.8 dB: -47.4 - 23.2 - 3.8; and 0.1 m where the source is nearer than that.
  const FaceSet wall({{4900, -9000, 4900, 9000}, {5100, -9000, 5100, 9000}}, {38, 38});
  const MapValues map = Highest(wall, {{{0, 0}, kRadio}}, {{-1.0, -1.0}, 2.0, 1, 6});
  EXPECT_NEAR(map(0, 5), -74.4, 1e-5);
  EXPECT_NEAR(map(0, 0), -47.4 + 23.2, 1e-5);
}

TEST(FieldMap, IsTheReferenceUpToTheFloatsOfTheLogarithm) {
  std::mt19937 generator(1);
  for (int plan = 0; plan < 6; ++plan) {
    const FaceSet faces = scenes::Walls(&generator, 10, 50);
    const plan::GridShape grid{{0.0, 0.0}, plan % 2 == 0 ? 0.25 : 0.05, 160, 240};
    const PointMm source{scenes::Draw(&generator, 0, 50'000), scenes::Draw(&generator, 0, 30'000)};
    for (const bool is_radio : {true, false}) {
      const Fading& fading = is_radio ? kRadio : kVoice;
      const CellValues expected = reference::Map(faces, source, fading, grid);
      const MapValues map = Highest(faces, {{source, fading}}, grid);
      const double error_db = (map.cast<double>() - expected).cwiseAbs().maxCoeff();
      ASSERT_LE(error_db, is_radio ? kRadioErrorDb : kVoiceErrorDb) << plan;
    }
  }
}

TEST(FieldMap, IsTheSameToTheBitWithEveryInstructionSet) {
  std::mt19937 generator(2);
  for (int plan = 0; plan < 8; ++plan) {
    const FaceSet faces = scenes::Walls(&generator, plan % 2 == 0 ? 20 : 600, 50);  // 16 and 32 bits
    const plan::GridShape grid{{0.0, 0.0}, plan < 4 ? 0.05 : 0.5, 70, 1100 + 7 * plan};
    const std::vector<FieldSource> sources = {{{20'000, 2'000}, kRadio}, {{1'000, 30'000}, kRadio}};
    const MapValues portable = Highest(faces, sources, grid, {1, base::Simd::kPortable});
    for (const base::Simd simd : Supported()) ASSERT_TRUE(SameBits(Highest(faces, sources, grid, {1, simd}), portable));
  }
}

TEST(FieldMap, IsTheSameToTheBitWithAnyNumberOfThreads) {
  std::mt19937 generator(3);
  const FaceSet faces = scenes::Walls(&generator, 40, 50);
  const std::vector<FieldSource> sources = {{{20'000, 2'000}, kRadio}, {{1'000, 30'000}, kRadio}};
  const MapValues one = Highest(faces, sources, kGrid, {1});
  for (const int threads : {0, 2, 3, 16}) EXPECT_TRUE(SameBits(Highest(faces, sources, kGrid, {threads}), one));
}

TEST(FieldMap, OfSeveralSourcesIsTheHighestInEachCell) {
  std::mt19937 generator(4);
  const FaceSet faces = scenes::Walls(&generator, 40, 50);
  const std::vector<FieldSource> sources = {{{20'000, 2'000}, kRadio}, {{1'000, 30'000}, kRadio}, {{9, 9}, kVoice}};
  MapValues expected = Highest(faces, {sources[0]}, kGrid);
  for (const FieldSource& source : sources) expected = expected.cwiseMax(Highest(faces, {source}, kGrid));
  EXPECT_TRUE(SameBits(Highest(faces, sources, kGrid), expected));
}

TEST(FieldMap, OfEachSourceIsThatOfTheSourceAlone) {
  std::mt19937 generator(5);
  const FaceSet faces = scenes::Walls(&generator, 40, 50);
  std::vector<FieldSource> sources;
  for (int i = 0; i < 5; ++i) sources.push_back({{7'000 * i, 6'000 * i}, kRadio});
  for (const int threads : {1, 2, 0}) {
    MapValues maps(5 * kGrid.rows, kGrid.cols);
    WriteEach(faces, sources, kGrid, maps, {threads});
    for (int i = 0; i < 5; ++i) {
      EXPECT_TRUE(SameBits(maps.middleRows(i * kGrid.rows, kGrid.rows), Highest(faces, {sources[i]}, kGrid))) << i;
    }
  }
}

TEST(FieldMap, CountsWallsExactlyWithTwentyThousandFaces) {
  std::mt19937 generator(6);
  const FaceSet faces = scenes::Walls(&generator, 5000, 50, 600);
  ASSERT_EQ(faces.Size(), 20'000u);
  const plan::GridShape grid{{0.0, 0.0}, 2.0, 20, 30};
  const PointMm source{31'003, 17'011};
  const CellCentersMm cells(grid);
  const std::vector<std::int32_t> weights = WeightsFrom(faces, source, grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      ASSERT_EQ(weights[row * grid.cols + col], reference::Weight(faces, source, cells, row, col));
    }
  }
}

TEST(FieldMap, RefusesWhatDoesNotFit) {
  const FaceSet nothing({}, {});
  MapValues map(kGrid.rows, kGrid.cols);
  MapValues small(kGrid.rows, kGrid.cols - 1);
  EXPECT_THROW(WriteHighest(nothing, {}, kGrid, map), std::invalid_argument);
  EXPECT_THROW(WriteHighest(nothing, {{{0, 0}, kRadio}}, kGrid, small), std::invalid_argument);
  EXPECT_THROW(WriteEach(nothing, {{{0, 0}, kRadio}, {{1, 0}, kRadio}}, kGrid, map), std::invalid_argument);
  EXPECT_THROW(WriteHighest(nothing, {{{0, 0}, {0.0, 20.0, 1.0, 0.0}}}, kGrid, map), std::invalid_argument);
  EXPECT_THROW(WriteHighest(nothing, {{{0, 0}, kRadio}}, kGrid, map, {-1}), std::invalid_argument);
}

TEST(FadeRows, AreRefusedWhereTheMachineDoesNotHaveThem) {
  for (const base::Simd simd : {base::Simd::kPortable, base::Simd::kAvx2, base::Simd::kAvx512}) {
    if (base::IsSupported(simd)) {
      EXPECT_NO_THROW(FadeRowsFor<std::int16_t>(simd));
    } else {
      EXPECT_THROW(FadeRowsFor<std::int16_t>(simd), std::invalid_argument);
    }
  }
  EXPECT_TRUE(base::IsSupported(base::BestSimd()));
}

}  // namespace
}  // namespace robotteamsim::propagation
