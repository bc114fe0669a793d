// Graphs for tests and benchmarks.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "robotteamsim/network/hop_count.hpp"
#include "robotteamsim/network/link_bits.hpp"

namespace robotteamsim::network::graphs {

inline Adjacency Empty(int n) { return Adjacency::Constant(n, n, false); }

inline void Link(int i, int j, Adjacency* adjacency) { (*adjacency)(i, j) = (*adjacency)(j, i) = true; }

inline Adjacency Path(int n) {
  Adjacency adjacency = Empty(n);
  for (int i = 0; i + 1 < n; ++i) Link(i, i + 1, &adjacency);
  return adjacency;
}

inline Adjacency Cycle(int n) {
  Adjacency adjacency = Path(n);
  Link(0, n - 1, &adjacency);
  return adjacency;
}

/// Robot 0 has a link to each other one.
inline Adjacency Star(int n) {
  Adjacency adjacency = Empty(n);
  for (int i = 1; i < n; ++i) Link(0, i, &adjacency);
  return adjacency;
}

inline Adjacency Complete(int n) {
  Adjacency adjacency = Adjacency::Constant(n, n, true);
  for (int i = 0; i < n; ++i) adjacency(i, i) = false;
  return adjacency;
}

/// Robots at random in a unit square, with a link where they are within reach; the same on every machine.
inline Adjacency Scattered(int n, double reach, std::uint32_t seed) {
  std::mt19937 generator(seed);
  constexpr double kDraws = 4294967296.0;
  Eigen::MatrixX2d at(n, 2);
  for (int i = 0; i < n; ++i) {
    at(i, 0) = generator() / kDraws;
    at(i, 1) = generator() / kDraws;
  }
  Adjacency adjacency = Empty(n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      if ((at.row(i) - at.row(j)).squaredNorm() <= reach * reach) Link(i, j, &adjacency);
    }
  }
  return adjacency;
}

/// The hops between all pairs by one search per robot through lists of neighbours; -1 where no path exists.
inline HopCount HopsOneByOne(const Adjacency& adjacency) {
  const int n = static_cast<int>(adjacency.rows());
  const Neighbors neighbors{LinkBits(adjacency)};
  HopCount hops = HopCount::Constant(n, n, -1);
  for (int first = 0; first < n; ++first) {
    hops(first, first) = 0;
    std::vector<int> reached{first};  // nearest first
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const int robot = reached[k];
      for (std::int32_t e = neighbors.start[robot]; e < neighbors.start[robot + 1]; ++e) {
        const int neighbor = neighbors.robots[e];
        if (hops(first, neighbor) >= 0) continue;
        hops(first, neighbor) = hops(first, robot) + 1;
        reached.push_back(neighbor);
      }
    }
  }
  return hops;
}

}  // namespace robotteamsim::network::graphs
