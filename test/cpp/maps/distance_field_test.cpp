#include "robotteamsim/maps/distance_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace robotteamsim::maps {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Five by five cells of 0.5 m from (-1, 2); only the one in row 1 and column 3 is occupied: x 0.5 to 1, y 2.5 to 3.
DistanceField OneOccupied() {
  std::vector<std::uint8_t> occupied(25, 0);
  occupied[1 * 5 + 3] = 1;
  return DistanceField({{-1.0, 2.0}, 0.5, 5, 5}, occupied);
}

TEST(DistanceField, IsTheDistanceBetweenCentresOfCells) {
  const std::vector<float> distances_m = OneOccupied().distances_m();
  EXPECT_EQ(distances_m[1 * 5 + 3], 0.0F);
  EXPECT_EQ(distances_m[1 * 5 + 0], 1.5F);
  EXPECT_FLOAT_EQ(distances_m[4 * 5 + 0], static_cast<float>(0.5 * std::sqrt(18.0)));
}

TEST(DistanceField, IsInfiniteWhereNothingIsOccupied) {
  const DistanceField field({{0.0, 0.0}, 1.0, 2, 3}, std::vector<std::uint8_t>(6, 0));
  for (const float distance_m : field.distances_m()) EXPECT_EQ(distance_m, kInfinity);
  EXPECT_EQ(field.Trace({0.5, 0.5}, {1.0, 0.0}, 10.0), kInfinity);
}

TEST(DistanceField, BeamEndsAtTheBorderOfAnOccupiedCell) {
  const DistanceField field = OneOccupied();
  EXPECT_NEAR(field.Trace({-0.9, 2.6}, {1.0, 0.0}, 9.0), 1.4, 1e-6);
  // Along a diagonal of the grid to the corner of the cell.
  const double half = std::sqrt(0.5);
  EXPECT_NEAR(field.Trace({0.05, 2.1}, {half, half}, 9.0), 0.45 / half, 1e-6);
  EXPECT_EQ(field.Trace({0.7, 2.6}, {1.0, 0.0}, 9.0), 0.0);  // begins in it
}

TEST(DistanceField, BeamHasNoEndBeyondTheRangeOrTheGrid) {
  const DistanceField field = OneOccupied();
  EXPECT_EQ(field.Trace({-0.9, 2.6}, {1.0, 0.0}, 1.3), kInfinity);
  EXPECT_EQ(field.Trace({-0.9, 2.6}, {0.0, 1.0}, 9.0), kInfinity);
  EXPECT_EQ(field.Trace({-5.0, 2.6}, {1.0, 0.0}, 9.0), kInfinity);  // begins outside
}

TEST(DistanceField, RefusesCellsThatDoNotFillTheShape) {
  EXPECT_THROW(DistanceField({{0.0, 0.0}, 0.1, 2, 2}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(DistanceField({{0.0, 0.0}, 0.0, 1, 1}, {0}), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::maps
