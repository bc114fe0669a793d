#include "robotteamsim/control/cell_paths.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

namespace robotteamsim::control {
namespace {

/// A floor of 3 m x 1 m in cells of 1 m; a wall of 0.1 m cells blocks all of the last cell.
CellPaths Row() {
  std::vector<std::uint8_t> occupied(10 * 30, 0);
  for (int cell = 0; cell < 10 * 30; ++cell) occupied[cell] = cell % 30 >= 19;
  const auto fine = std::make_shared<const plan::PlanningGrid>(plan::GridShape{{0.0, 0.0}, 0.1, 10, 30}, occupied, 0.0);
  return CellPaths(fine, {{0.0, 0.0}, 1.0, 1, 3}, std::nullopt);
}

TEST(CellPaths, HavePlacesOnlyInFreeCells) {
  const CellPaths paths = Row();
  EXPECT_NEAR(paths.PlaceOf(0)->x, 0.5, 0.1);
  EXPECT_FALSE(paths.PlaceOf(2).has_value());
}

TEST(CellPaths, LengthBetweenIsThatOfAllLengthsFrom) {
  const CellPaths paths = Row();
  EXPECT_NEAR(paths.LengthBetween(0, 1), 1.0F, 1e-6F);
  EXPECT_EQ(paths.LengthBetween(0, 1), paths.LengthsFrom(0)[1]);
  EXPECT_TRUE(std::isinf(paths.LengthBetween(0, 2)));
}

TEST(CellPaths, RefuseCellsBeyondTheGrid) {
  const CellPaths paths = Row();
  for (const int cell : {-1, 3}) {
    EXPECT_THROW(paths.PlaceOf(cell), std::invalid_argument);
    EXPECT_THROW(paths.LengthsFrom(cell), std::invalid_argument);
    EXPECT_THROW(paths.LengthBetween(0, cell), std::invalid_argument);
    EXPECT_THROW(paths.LengthBetween(cell, 0), std::invalid_argument);
  }
}

/// An empty floor of 3 m x 3 m in cells of 1 m.
CellPaths Square() {
  const std::vector<std::uint8_t> free(30 * 30, 0);
  const auto fine = std::make_shared<const plan::PlanningGrid>(plan::GridShape{{0.0, 0.0}, 0.1, 30, 30}, free, 0.0);
  return CellPaths(fine, {{0.0, 0.0}, 1.0, 3, 3}, std::nullopt);
}

TEST(CellPaths, WayWithinAllowedCellsGoesAroundTheOthers) {
  const CellPaths paths = Square();
  const std::vector<std::uint8_t> goals{0, 0, 1, 0, 0, 0, 0, 0, 0};
  const auto straight = paths.WayWithin({0.5, 0.5}, goals, std::vector<std::uint8_t>(9, 1), 8.0);
  ASSERT_TRUE(straight.has_value());
  EXPECT_EQ(straight->cells, (std::vector<int>{0, 1, 2}));
  EXPECT_NEAR(straight->ahead.x, 2.5, 0.1);
  const auto around = paths.WayWithin({0.5, 0.5}, goals, {1, 0, 1, 1, 1, 1, 1, 1, 1}, 8.0);
  ASSERT_TRUE(around.has_value());
  EXPECT_EQ(around->cells, (std::vector<int>{0, 4, 2}));
  EXPECT_NEAR(around->ahead.x, 1.5, 0.1);  // the straight line to the goal crosses the cell that is not allowed
  EXPECT_FALSE(paths.WayWithin({0.5, 0.5}, goals, {1, 0, 1, 1, 0, 1, 1, 0, 1}, 8.0).has_value());
}

TEST(CellPaths, WayWithinNeedsAValuePerCell) {
  const std::vector<std::uint8_t> all(9, 1);
  EXPECT_THROW(Square().WayWithin({0.5, 0.5}, {1}, all, 8.0), std::invalid_argument);
  EXPECT_THROW(Square().WayWithin({0.5, 0.5}, all, {1}, 8.0), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::control
