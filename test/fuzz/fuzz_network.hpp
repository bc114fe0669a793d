// Any graph of robots: hops against a plain search, the Fiedler value against all eigenvalues.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "fuzz_bytes.hpp"
#include "robotteamsim/network/fiedler.hpp"
#include "robotteamsim/network/hop_count.hpp"

namespace robotteamsim::fuzz {

/// Returns the shortest ways by Floyd and Warshall; -1 where there is none.
inline network::HopCount PlainHops(const network::Adjacency& adjacency) {
  const auto n = static_cast<int>(adjacency.rows());
  const int never = n + 1;
  network::HopCount hops = network::HopCount::Constant(n, n, never);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i == j || adjacency(i, j)) hops(i, j) = i == j ? 0 : 1;
    }
  }
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) hops(i, j) = std::min(hops(i, j), hops(i, k) + hops(k, j));
    }
  }
  return (hops.array() >= never).select(-1, hops);
}

/// Draws a graph: mostly of a few bytes' pattern, at times not square, not symmetric, or with a link to oneself.
inline network::Adjacency DrawAdjacency(Bytes* bytes) {
  const auto n = bytes->Draw(0, 63);
  const bool odd_shape = bytes->Draw(0, 63) == 0;
  network::Adjacency adjacency = network::Adjacency::Constant(n, odd_shape ? bytes->Draw(0, 63) : n, false);
  if (adjacency.rows() == 0 || adjacency.cols() == 0) return adjacency;
  const auto shape = bytes->Draw(0, 3);  // chains and rings have the closest eigenvalues
  for (Eigen::Index i = 0; i + 1 < std::min(adjacency.rows(), adjacency.cols()) && shape > 1; ++i) {
    adjacency(i, i + 1) = adjacency(i + 1, i) = true;
  }
  if (shape == 3 && adjacency.rows() == adjacency.cols() && adjacency.rows() > 2) {
    adjacency(0, adjacency.cols() - 1) = adjacency(adjacency.rows() - 1, 0) = true;
  }
  const auto links = bytes->Draw(0, 150);
  const bool mirror = bytes->Draw(0, 31) != 0;
  for (std::int64_t link = 0; link < links && bytes->Left() > 0; ++link) {
    const auto i = bytes->Draw(0, adjacency.rows() - 1);
    const auto j = bytes->Draw(0, adjacency.cols() - 1);
    if (i == j && mirror) continue;
    adjacency(i, j) = true;
    if (mirror && !odd_shape) adjacency(j, i) = true;
  }
  return adjacency;
}

/// Returns the second-smallest eigenvalue of the Laplacian, of all that there are; 1 for a single robot.
inline double PlainFiedlerValue(const network::Adjacency& adjacency) {
  if (adjacency.rows() == 1) return 1.0;
  const Eigen::MatrixXd links = adjacency.cast<double>();
  const Eigen::MatrixXd laplacian = Eigen::MatrixXd(links.rowwise().sum().asDiagonal()) - links;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian, Eigen::EigenvaluesOnly).eigenvalues()(1);
}

inline void CheckFiedlerValue(const network::Adjacency& adjacency, const network::HopCount& hops) {
  if (hops.rows() == 0) return;
  const double value = network::FiedlerValue(adjacency);
  Check((value == 0.0) == (hops.minCoeff() < 0), "the Fiedler value is 0 exactly where the team is split");
  if (value == 0.0) return;
  const double expected = PlainFiedlerValue(adjacency);
  Check(std::abs(value - expected) <= 100.0 * network::kFiedlerTolerance * expected + 1e-12,
        "the Fiedler value is the reference");
  Check(network::FiedlerValue(adjacency) == value, "the same links give the same bits");
}

/// Throws Disagreement where two ways of computing disagree; anything else that escapes is a mistake as well.
inline void FuzzNetwork(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const network::Adjacency adjacency = DrawAdjacency(&bytes);
  const bool sound =
      adjacency.rows() == adjacency.cols() && adjacency == adjacency.transpose() && !adjacency.diagonal().any();
  try {
    const network::HopCount hops = network::CountHops(adjacency);
    Check(sound, "what is no graph is refused");
    Check(hops == PlainHops(adjacency), "hops are the shortest ways");
    CheckFiedlerValue(adjacency, hops);
  } catch (const std::invalid_argument&) {
    Check(!sound, "only what is no graph is refused");
  }
}

}  // namespace robotteamsim::fuzz
