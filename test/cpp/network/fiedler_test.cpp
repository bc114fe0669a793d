#include "robotteamsim/network/fiedler.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "graphs.hpp"

namespace robotteamsim::network {
namespace {

constexpr double kPi = 3.141592653589793;

/// The second of all eigenvalues of Lp = D - A.
double OfAllEigenvalues(const Adjacency& adjacency) {
  Eigen::MatrixXd laplacian = -adjacency.cast<double>();
  laplacian.diagonal() = adjacency.cast<double>().rowwise().sum();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian, Eigen::EigenvaluesOnly).eigenvalues()[1];
}

TEST(FiedlerValue, OfAPathIsItsClosedForm) {
  for (const int n : {2, 3, 24, 25, 100, 1000}) {
    const double expected = 4.0 * std::pow(std::sin(kPi / (2.0 * n)), 2);
    EXPECT_NEAR(FiedlerValue(graphs::Path(n)) / expected, 1.0, kFiedlerTolerance) << n;
  }
}

TEST(FiedlerValue, OfACycleIsItsClosedForm) {
  for (const int n : {3, 24, 25, 100, 1000}) {
    const double expected = 4.0 * std::pow(std::sin(kPi / n), 2);
    EXPECT_NEAR(FiedlerValue(graphs::Cycle(n)) / expected, 1.0, kFiedlerTolerance) << n;
  }
}

TEST(FiedlerValue, OfAStarIsOne) {
  for (const int n : {3, 24, 25, 100, 500}) {
    EXPECT_NEAR(FiedlerValue(graphs::Star(n)), 1.0, kFiedlerTolerance) << n;
  }
}

TEST(FiedlerValue, OfACompleteGraphIsItsNumberOfRobots) {
  for (const int n : {1, 2, 24, 25, 63, 64, 65, 300}) EXPECT_EQ(FiedlerValue(graphs::Complete(n)), n);
}

TEST(FiedlerValue, IsFoundWhereFewEigenvaluesAreDifferent) {
  for (const int n : {10, 26, 30, 64, 100, 128, 256, 300}) {
    Adjacency one_missing = graphs::Complete(n);
    one_missing(0, 1) = one_missing(1, 0) = false;
    EXPECT_NEAR(FiedlerValue(one_missing) / (n - 2), 1.0, kFiedlerTolerance) << n;
    Adjacency pairs_missing = graphs::Complete(n);
    for (int i = 0; i < n; i += 2) pairs_missing(i, i + 1) = pairs_missing(i + 1, i) = false;
    EXPECT_NEAR(FiedlerValue(pairs_missing) / (n - 2), 1.0, kFiedlerTolerance) << n;
    for (const int part : {1, 2, 5, n / 3, n / 2}) {  // two parts, each robot linked to all of the other part
      Adjacency bipartite = graphs::Empty(n);
      bipartite.topRightCorner(part, n - part).setConstant(true);
      bipartite.bottomLeftCorner(n - part, part).setConstant(true);
      EXPECT_NEAR(FiedlerValue(bipartite) / part, 1.0, kFiedlerTolerance) << n << " " << part;
    }
  }
}

TEST(FiedlerValue, IsTheSecondOfAllEigenvaluesOfSparseAndOfDenseTeams) {
  int connected = 0;
  for (const int n : {10, 24, 25, 26, 64, 100, 129, 300}) {
    for (const double reach : {0.15, 0.2, 0.3, 0.45, 0.7, 1.0}) {
      const Adjacency adjacency = graphs::Scattered(n, reach, 8);
      const double value = FiedlerValue(adjacency);
      if (value == 0.0) continue;
      ++connected;
      EXPECT_NEAR(value, OfAllEigenvalues(adjacency), 1e-11 * n + kFiedlerTolerance * value) << n << " " << reach;
    }
  }
  EXPECT_GT(connected, 25);
}

TEST(FiedlerValue, OfTwoCrowdsAndOneLinkBetweenThemIsFound) {
  // Nearly split: far below all other eigenvalues, for factors (of two cliques of 30) and for bits (of 100).
  for (const int half : {30, 100}) {
    Adjacency adjacency = graphs::Empty(2 * half);
    adjacency.topLeftCorner(half, half) = graphs::Complete(half);
    adjacency.bottomRightCorner(half, half) = graphs::Complete(half);
    graphs::Link(0, 2 * half - 1, &adjacency);
    EXPECT_NEAR(FiedlerValue(adjacency), OfAllEigenvalues(adjacency), 1e-11 * half);
  }
}

TEST(FiedlerValue, IsExactlyZeroWhereTheTeamIsSplit) {
  for (const int n : {2, 5, 24, 25, 300}) {
    EXPECT_EQ(FiedlerValue(graphs::Empty(n)), 0.0);
    Adjacency one_apart = graphs::Complete(n);
    one_apart.row(n / 2).setConstant(false);
    one_apart.col(n / 2).setConstant(false);
    EXPECT_EQ(FiedlerValue(one_apart), 0.0);
  }
}

TEST(FiedlerValue, IsTheSameToTheBitEachTime) {
  for (const double reach : {0.2, 0.7}) {
    const Adjacency adjacency = graphs::Scattered(200, reach, 9);
    EXPECT_EQ(FiedlerValue(adjacency), FiedlerValue(adjacency));
  }
}

TEST(FiedlerValue, RefusesATeamOfNoneAndWhatIsNoUndirectedGraph) {
  EXPECT_THROW(FiedlerValue(graphs::Empty(0)), std::invalid_argument);
  EXPECT_THROW(FiedlerValue(Adjacency::Constant(2, 3, false)), std::invalid_argument);
  EXPECT_THROW(FiedlerValue(Adjacency::Constant(2, 2, true)), std::invalid_argument);
}

}  // namespace
}  // namespace robotteamsim::network
