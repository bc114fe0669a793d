#include "robotteamsim/network/hop_count.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace robotteamsim {
namespace {

std::vector<std::vector<int>> Neighbors(const Eigen::Ref<const Adjacency>& adjacency) {
  const auto pair = [](int i, int j) { return "(" + std::to_string(i) + ", " + std::to_string(j) + ")"; };
  const int n = static_cast<int>(adjacency.rows());
  if (adjacency.cols() != n) {
    throw std::invalid_argument("adjacency must be square, got shape " + pair(n, static_cast<int>(adjacency.cols())));
  }
  std::vector<std::vector<int>> neighbors(n);
  for (int i = 0; i < n; ++i) {
    if (adjacency(i, i)) throw std::invalid_argument("adjacency must be 0 on the diagonal, is 1 at " + pair(i, i));
    for (int j = 0; j < n; ++j) {
      if (adjacency(i, j) != adjacency(j, i)) {
        throw std::invalid_argument("adjacency must be symmetric, is not at " + pair(i, j));
      }
      if (adjacency(i, j)) neighbors[i].push_back(j);
    }
  }
  return neighbors;
}

}  // namespace

HopCount CountHops(const Eigen::Ref<const Adjacency>& adjacency) {
  const std::vector<std::vector<int>> neighbors = Neighbors(adjacency);
  const int n = static_cast<int>(neighbors.size());
  HopCount hops = HopCount::Constant(n, n, -1);
  std::vector<int> reached;  // by the search from one robot, nearest first
  for (int source = 0; source < n; ++source) {
    hops(source, source) = 0;
    reached.assign(1, source);
    for (std::size_t k = 0; k < reached.size(); ++k) {
      const int robot = reached[k];
      for (const int neighbor : neighbors[robot]) {
        if (hops(source, neighbor) >= 0) continue;
        hops(source, neighbor) = hops(source, robot) + 1;
        reached.push_back(neighbor);
      }
    }
  }
  return hops;
}

}  // namespace robotteamsim
