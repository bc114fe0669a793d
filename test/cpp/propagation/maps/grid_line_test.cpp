#include "robotteamsim/propagation/maps/grid_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "../scenes.hpp"

namespace robotteamsim::propagation {
namespace {

CellCentersMm Cells(double resolution_m, int rows, int cols) {
  return CellCentersMm({{-2.0, -1.0}, resolution_m, rows, cols});
}

TEST(GridLine, PassesCentresBelowItAndStopsAtThoseOnItIfTheyCount) {
  const CellCentersMm cells = Cells(0.1, 20, 20);  // centres at -1950, -1850, ... and -950, -850, ...
  GridLine line{-1950, -950, 100, 100, false};     // through every centre of the diagonal
  EXPECT_EQ(FirstBeyond(line, cells.x.at[3], cells.y), 4);
  line.centers_on_it_are_beyond = true;
  EXPECT_EQ(FirstBeyond(line, cells.x.at[3], cells.y), 3);
  line.across += 1;
  EXPECT_EQ(FirstBeyond(line, cells.x.at[3], cells.y), 4);
}

TEST(GridLine, StepsAreWhatDivisionsGive) {
  std::mt19937 generator(1);
  int stepped = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::int64_t size = i % 3 == 0 ? 5'000'000 : 3000;
    const CellCentersMm cells = Cells(static_cast<double>(scenes::Draw(&generator, 1, 400)) / 1000.0, 60, 80);
    const auto draw = [&] { return scenes::Draw(&generator, -size, size); };
    const GridLine line{draw(), draw(), scenes::Draw(&generator, 1, size), draw(), i % 2 == 0};
    const std::optional<SteppedLine> steps = StepsOf(line, cells.x, cells.y, 5, 70);
    if (!steps) continue;
    ++stepped;
    ASSERT_NE(steps->step, 0);
    for (int k = 0; k < 70; ++k) {
      ASSERT_EQ(std::clamp(steps->At(k), 0, 60), FirstBeyond(line, cells.x.at[5 + k], cells.y)) << i << " " << k;
    }
  }
  EXPECT_GT(stepped, 2000);
}

TEST(GridLine, HasNoStepsWhereTheyWouldNotBeExact) {
  const CellCentersMm cells = Cells(0.05, 60, 80);
  EXPECT_FALSE(StepsOf({0, 0, 1, 1'000'000'000, false}, cells.x, cells.y, 0, 80));  // too steep
  EXPECT_FALSE(StepsOf({0, 0, 2'000'000'000, 1, false}, cells.x, cells.y, 0, 80));  // too fine a fraction
  const CellCentersMm uneven = Cells(0.0333, 60, 80);
  EXPECT_FALSE(StepsOf({0, 0, 100, 50, false}, uneven.x, uneven.y, 0, 80));
}

TEST(GridLine, InsideTheGridAreAllCentresWhereItPassesBetweenTwo) {
  std::mt19937 generator(2);
  for (int i = 0; i < 3000; ++i) {
    const std::int64_t size = i % 3 == 0 ? 900'000'000 : 5000;
    const CellCentersMm cells = Cells(i % 4 == 0 ? 0.0333 : 0.04, 60, 80);
    const auto draw = [&] { return scenes::Draw(&generator, -size, size); };
    GridLine line{draw(), draw(), scenes::Draw(&generator, 1, size), draw(), false};
    if (i % 5 == 0) line.d_across = 0;
    const IndexRange range = InsideGrid(line, cells.x, cells.y, {3, 75});
    ASSERT_LE(range.first, range.last);
    for (int col = 3; col < 75; ++col) {
      const int row = FirstBeyond(line, cells.x.at[col], cells.y);
      if (row > 0 && row < 60) {
        ASSERT_TRUE(range.first <= col && col < range.last) << i << " " << col;
      }
    }
  }
}

}  // namespace
}  // namespace robotteamsim::propagation
