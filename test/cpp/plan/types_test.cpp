#include <gtest/gtest.h>

#include "robotteamsim/plan/types.hpp"

TEST(Point, IsTheOriginByDefault) {
  const robotteamsim::Point point;
  EXPECT_EQ(point.x, 0.0);
  EXPECT_EQ(point.y, 0.0);
}
