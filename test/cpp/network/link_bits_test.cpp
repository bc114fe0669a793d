#include "robotteamsim/network/link_bits.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "graphs.hpp"

namespace robotteamsim::network {
namespace {

std::string MessageFor(const Adjacency& adjacency) {
  try {
    LinkBits bits(adjacency);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LinkBits, HoldsEachLinkAtItsPlaceAndNothingBeyondTheTeam) {
  for (const int n : {0, 1, 7, 63, 64, 65, 255, 256, 257, 300}) {
    const Adjacency adjacency = graphs::Scattered(n, 0.3, 1);
    const LinkBits links(adjacency);
    ASSERT_EQ(links.NumRobots(), n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < links.NumWords() * LinkBits::kBitsPerWord; ++j) {
        const bool bit = (links.Row(i)[j / LinkBits::kBitsPerWord] >> (j % LinkBits::kBitsPerWord) & 1) != 0;
        ASSERT_EQ(bit, j < n && adjacency(i, j)) << n << ": " << i << ", " << j;
      }
    }
  }
}

TEST(LinkBits, TakesAPartOfALargerMatrix) {
  const Adjacency large = graphs::Scattered(100, 0.3, 2);
  const LinkBits part(large.topLeftCorner(70, 70));
  for (int j = 0; j < 70; ++j) EXPECT_EQ((part.Row(69)[j / 64] >> (j % 64) & 1) != 0, large(69, j));
}

TEST(LinkBits, NamesThePlaceOfWhatIsNoUndirectedGraph) {
  EXPECT_EQ(MessageFor(Adjacency::Constant(2, 3, false)), "adjacency must be square, got shape (2, 3)");
  Adjacency to_itself = graphs::Path(70);
  to_itself(66, 66) = true;
  EXPECT_EQ(MessageFor(to_itself), "adjacency must be 0 on the diagonal, got 1 at (66, 66)");
  for (const auto& [i, j] : {std::pair{0, 1}, {3, 299}, {64, 127}, {298, 299}}) {
    Adjacency one_way = graphs::Scattered(300, 0.2, 3);
    one_way(j, i) = !one_way(i, j);
    const std::string place = "(" + std::to_string(i) + ", " + std::to_string(j) + ")";
    EXPECT_EQ(MessageFor(one_way), "adjacency must be symmetric, but is not at " + place);
    one_way(i, j) = !one_way(i, j);
    one_way(j, i) = !one_way(j, i);
    EXPECT_EQ(MessageFor(one_way), "adjacency must be symmetric, but is not at " + place);
  }
}

TEST(LinkBits, CountsTheLinksOfARobot) {
  const LinkBits star(graphs::Star(300));
  EXPECT_EQ(star.Degree(0), 299);
  EXPECT_EQ(star.Degree(299), 1);
}

TEST(LinkBits, TellsWhetherEveryRobotHasAWayToEveryOtherOne) {
  for (const int n : {1, 2, 64, 65, 300}) {
    EXPECT_TRUE(LinkBits(graphs::Path(n)).IsConnected());
    EXPECT_TRUE(LinkBits(graphs::Complete(n)).IsConnected());
    EXPECT_EQ(LinkBits(graphs::Empty(n)).IsConnected(), n == 1);
    if (n == 1) continue;
    for (const int cut : {0, n / 2 - 1, n - 2}) {
      Adjacency split = graphs::Path(n);
      split(cut, cut + 1) = split(cut + 1, cut) = false;
      EXPECT_FALSE(LinkBits(split).IsConnected()) << n << " " << cut;
    }
  }
  EXPECT_TRUE(LinkBits(graphs::Empty(0)).IsConnected());
}

TEST(Neighbors, AreTheLinksInAscendingOrder) {
  const Adjacency adjacency = graphs::Scattered(130, 0.2, 4);
  const Neighbors neighbors{LinkBits(adjacency)};
  for (int i = 0; i < 130; ++i) {
    std::int32_t e = neighbors.start[i];
    for (int j = 0; j < 130; ++j) {
      if (adjacency(i, j)) ASSERT_EQ(neighbors.robots[e++], j);
    }
    EXPECT_EQ(e, neighbors.start[i + 1]);
    EXPECT_EQ(neighbors.Count(i), adjacency.row(i).count());
  }
}

}  // namespace
}  // namespace robotteamsim::network
