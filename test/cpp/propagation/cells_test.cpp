#include "robotteamsim/propagation/cells.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace robotteamsim::propagation {
namespace {

TEST(CellCenters, LieAtWholeMillimetresOnePitchApart) {
  const CellCentersMm cells({{-1.0, 2.0}, 0.05, 3, 4});
  EXPECT_EQ(cells.x.pitch, 50);
  EXPECT_EQ(cells.x.at, (std::vector<std::int64_t>{-975, -925, -875, -825}));
  EXPECT_EQ(cells.y.at, (std::vector<std::int64_t>{2025, 2075, 2125}));
  EXPECT_EQ(cells.At(2, 1).x, -925);
  EXPECT_EQ(cells.At(2, 1).y, 2125);
}

TEST(CellCenters, KeepThePitchWhereCentresLieOnHalfMillimetres) {
  // The centres are at -27.5, 27.5 and 82.5 mm; the first is rounded away from zero.
  const CellCentersMm cells({{-0.055, 0.0}, 0.055, 1, 3});
  EXPECT_EQ(cells.x.at, (std::vector<std::int64_t>{-28, 27, 82}));
}

TEST(CellCenters, AreRoundedOneByOneWhereTheResolutionIsNotAWholeMillimetre) {
  const CellCentersMm cells({{0.0, 0.0}, 0.0333, 1, 4});
  EXPECT_EQ(cells.x.pitch, 0);
  EXPECT_EQ(cells.x.at, (std::vector<std::int64_t>{17, 50, 83, 117}));
}

TEST(CellCenters, TellTheFirstFromAPosition) {
  for (const double resolution_m : {0.05, 0.0333}) {
    const CellCentersMm cells({{-0.2, 0.0}, resolution_m, 1, 20});
    for (std::int64_t position = -400; position < 1000; ++position) {
      int expected = 0;
      while (expected < 20 && cells.x.at[expected] < position) ++expected;
      ASSERT_EQ(cells.x.FirstFrom(position), expected) << position;
    }
  }
}

TEST(CellCenters, RefuseGridsWithoutCellsAndBeyondTheLimit) {
  EXPECT_THROW(CellCentersMm({{0.0, 0.0}, 0.0, 4, 4}), std::invalid_argument);
  EXPECT_THROW(CellCentersMm({{0.0, 0.0}, -1.0, 4, 4}), std::invalid_argument);
  EXPECT_THROW(CellCentersMm({{0.0, 0.0}, 0.1, 0, 4}), std::invalid_argument);
  EXPECT_THROW(CellCentersMm({{0.0, 0.0}, 0.1, 4, 0}), std::invalid_argument);
  EXPECT_THROW(CellCentersMm({{999'999.0, 0.0}, 1.0, 1, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::propagation
