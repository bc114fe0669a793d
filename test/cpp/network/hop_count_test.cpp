#include "robotteamsim/network/hop_count.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace robotteamsim {
namespace {

Adjacency Path(int n) {
  Adjacency adjacency = Adjacency::Constant(n, n, false);
  for (int i = 0; i + 1 < n; ++i) adjacency(i, i + 1) = adjacency(i + 1, i) = true;
  return adjacency;
}

TEST(CountHops, IsTheDistanceAlongAPath) {
  const HopCount hops = CountHops(Path(6));
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) EXPECT_EQ(hops(i, j), std::abs(i - j));
  }
}

TEST(CountHops, TakesTheShorterWayAroundARing) {
  Adjacency ring = Path(6);
  ring(0, 5) = ring(5, 0) = true;
  EXPECT_EQ(CountHops(ring)(0, 4), 2);
  EXPECT_EQ(CountHops(ring)(0, 3), 3);
}

TEST(CountHops, IsMinusOneWhereNoPathExists) {
  Adjacency split = Path(5);
  split(2, 3) = split(3, 2) = false;
  EXPECT_EQ(CountHops(split)(0, 4), -1);
  EXPECT_EQ(CountHops(split)(3, 4), 1);
}

TEST(CountHops, OfOneRobotIsZero) { EXPECT_EQ(CountHops(Path(1))(0, 0), 0); }

TEST(CountHops, RefusesWhatIsNoUndirectedGraph) {
  EXPECT_THROW(CountHops(Adjacency::Constant(2, 3, false)), std::invalid_argument);
  EXPECT_THROW(CountHops(Adjacency::Constant(2, 2, true)), std::invalid_argument);
  Adjacency one_way = Path(3);
  one_way(0, 1) = false;
  EXPECT_THROW(CountHops(one_way), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim
