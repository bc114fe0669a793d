#include "robotteamsim/maps/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace robotteamsim::maps {
namespace {

using Cells = std::vector<std::int8_t>;
using Bytes = std::vector<std::uint8_t>;

TEST(RunLengths, AreLengthsTimesFourPlusTheValue) {
  Cells cells(40, kUnknown);
  cells.insert(cells.end(), {kFree, kFree, kOccupied});
  // 40 * 4 + 0 = 160 takes two bytes: 32 with the highest bit, then 1.
  const Bytes expected{0xA0, 0x01, 2 * 4 + 1, 1 * 4 + 2};
  EXPECT_EQ(RunLengths(cells), expected);
  EXPECT_EQ(CellsOf(expected, 43), cells);
}

TEST(RunLengths, AreRefusedUnlessTheyAreThoseOfTheGrid) {
  EXPECT_THROW(CellsOf({}, 1), std::invalid_argument);
  EXPECT_THROW(CellsOf({9}, 1), std::invalid_argument);  // two cells
  EXPECT_THROW(CellsOf({9}, 3), std::invalid_argument);
  EXPECT_THROW(CellsOf({7}, 1), std::invalid_argument);     // no such value
  EXPECT_THROW(CellsOf({0x85}, 1), std::invalid_argument);  // ends within a number
  EXPECT_THROW(CellsOf(Bytes(6, 0xFF), 1), std::invalid_argument);
}

TEST(OccupancyGrid, IsCroppedToWhatIsKnown) {
  const OccupancyGrid part = Cropped({{{1.0, 2.0}, 0.5, 3, 4}, {-1, -1, -1, -1, -1, 0, 100, -1, -1, -1, 0, -1}});
  EXPECT_EQ(part.cells, (Cells{0, 100, -1, 0}));
  EXPECT_EQ(part.shape.origin.x, 1.5);
  EXPECT_EQ(part.shape.origin.y, 2.5);
  EXPECT_TRUE(Cropped({{{0.0, 0.0}, 0.5, 1, 2}, {-1, -1}}).cells.empty());
}

TEST(Fill, WritesAnotherGridAtItsPoseIntoUnknownCellsOnly) {
  OccupancyGrid grid{{{0.0, 0.0}, 1.0, 2, 2}, {-1, 0, -1, -1}};
  // Turned by a right angle about (2, 0): its first cell is the lower right one, the next one is above it.
  Fill(&grid, {{{0.0, 0.0}, 1.0, 1, 2}, {100, 100}}, {2.0, 0.0, std::acos(0.0)});
  EXPECT_EQ(grid.cells, (Cells{-1, 0, -1, 100}));
}

}  // namespace
}  // namespace robotteamsim::maps
