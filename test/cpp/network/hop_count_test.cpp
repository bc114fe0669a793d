#include "robotteamsim/network/hop_count.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "graphs.hpp"

namespace robotteamsim::network {
namespace {

/// C of eq. (18-20), with -1 where it stays 0 beside the diagonal.
HopCount ByTheRecurrence(const Adjacency& adjacency) {
  const int n = static_cast<int>(adjacency.rows());
  const HopCount a = adjacency.cast<std::int32_t>();
  HopCount c = a;
  for (int k = 2; k < n; ++k) {
    const HopCount product = c * a;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        if (i != j && c(i, j) == 0 && product(i, j) > 0) c(i, j) = -k;  // not yet for this k
      }
    }
    c = c.cwiseAbs();
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i != j && c(i, j) == 0) c(i, j) = -1;
    }
  }
  return c;
}

/// The same graph with its robots numbered otherwise.
Adjacency Shuffled(const Adjacency& adjacency, std::uint32_t seed) {
  std::mt19937 generator(seed);
  std::vector<int> number(adjacency.rows());
  std::iota(number.begin(), number.end(), 0);
  for (std::size_t i = number.size(); i > 1; --i) std::swap(number[i - 1], number[generator() % i]);
  Adjacency shuffled(adjacency.rows(), adjacency.cols());
  for (Eigen::Index i = 0; i < adjacency.rows(); ++i) {
    for (Eigen::Index j = 0; j < adjacency.cols(); ++j) shuffled(number[i], number[j]) = adjacency(i, j);
  }
  return shuffled;
}

TEST(CountHops, IsTheRecurrenceOfTheDissertation) {
  for (const int n : {2, 3, 8, 20, 63, 64, 65, 100}) {
    for (const double reach : {0.05, 0.1, 0.2, 0.5}) {
      const Adjacency adjacency = graphs::Scattered(n, reach, 5);
      ASSERT_EQ(CountHops(adjacency), ByTheRecurrence(adjacency)) << n << " " << reach;
    }
    ASSERT_EQ(CountHops(graphs::Path(n)), ByTheRecurrence(graphs::Path(n)));
    ASSERT_EQ(CountHops(graphs::Cycle(n)), ByTheRecurrence(graphs::Cycle(n)));
  }
}

TEST(CountHops, IsOneSearchPerRobotWhateverTheNumberOfRobots) {
  for (const int n : {1, 2, 127, 255, 256, 257, 511, 513, 700}) {
    for (const double reach : {0.02, 0.05, 0.1, 0.3, 2.0}) {
      const Adjacency adjacency = graphs::Scattered(n, reach, 6);
      ASSERT_EQ(CountHops(adjacency), graphs::HopsOneByOne(adjacency)) << n << " " << reach;
    }
  }
}

TEST(CountHops, IsTheDistanceAlongAPath) {
  for (const int n : {6, 64, 65, 150, 400}) {
    const HopCount hops = CountHops(graphs::Path(n));
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) ASSERT_EQ(hops(i, j), std::abs(i - j)) << n;
    }
  }
}

TEST(CountHops, IsTheShorterWayAroundACycle) {
  for (const int n : {6, 130, 200, 300}) {
    const HopCount hops = CountHops(graphs::Cycle(n));
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) ASSERT_EQ(hops(i, j), std::min(std::abs(i - j), n - std::abs(i - j))) << n;
    }
  }
}

TEST(CountHops, DoesNotDependOnTheNumbersOfTheRobots) {
  for (const Adjacency& ordered : {graphs::Path(90), graphs::Path(300), graphs::Cycle(290)}) {
    const Adjacency adjacency = Shuffled(ordered, 7);
    EXPECT_EQ(CountHops(adjacency), graphs::HopsOneByOne(adjacency));
    EXPECT_EQ(CountHops(adjacency).maxCoeff(), CountHops(ordered).maxCoeff());
  }
}

TEST(CountHops, IsMinusOneWhereNoPathExists) {
  Adjacency split = graphs::Path(400);
  split(200, 201) = split(201, 200) = false;
  const HopCount hops = CountHops(split);
  EXPECT_EQ(hops(0, 399), -1);
  EXPECT_EQ(hops(0, 200), 200);
  EXPECT_EQ(hops(201, 399), 198);
  EXPECT_TRUE((hops.topRightCorner(201, 199).array() == -1).all());
  HopCount alone = HopCount::Constant(300, 300, -1);
  for (int i = 0; i < 300; ++i) alone(i, i) = 0;
  EXPECT_EQ(CountHops(graphs::Empty(300)), alone);
}

TEST(CountHops, OfNoRobotIsEmptyAndOfOneIsZero) {
  EXPECT_EQ(CountHops(graphs::Empty(0)).size(), 0);
  EXPECT_EQ(CountHops(graphs::Empty(1))(0, 0), 0);
}

TEST(CountHops, RefusesWhatIsNoUndirectedGraph) {
  EXPECT_THROW(CountHops(Adjacency::Constant(2, 3, false)), std::invalid_argument);
  EXPECT_THROW(CountHops(Adjacency::Constant(2, 2, true)), std::invalid_argument);
  Adjacency one_way = graphs::Path(3);
  one_way(0, 1) = false;
  EXPECT_THROW(CountHops(one_way), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::network
