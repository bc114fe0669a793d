#include "robotteamsim/network/hop_count.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace robotteamsim::network {
namespace {

using Bits = std::vector<std::uint64_t>;

/// Calls visit(robot) for each bit, ascending, until it returns false.
template <typename Visit>
void ForEachBit(const Bits& bits, const Visit& visit) {
  for (std::size_t w = 0; w < bits.size(); ++w) {
    for (std::uint64_t left = bits[w]; left != 0; left &= left - 1) {
      if (!visit(static_cast<int>(w) * LinkBits::kBitsPerWord + __builtin_ctzll(left))) return;
    }
  }
}

/// Writes the hops from one robot to all that it can reach: robots of equal hops are found together.
void SearchFrom(const LinkBits& links, int first, std::int32_t* hops) {
  const auto num_words = static_cast<std::size_t>(links.NumWords());
  Bits unreached(num_words, 0), frontier(num_words, 0), next(num_words);
  for (int robot = 0; robot < links.NumRobots(); ++robot) {
    unreached[robot / LinkBits::kBitsPerWord] |= std::uint64_t{1} << (robot % LinkBits::kBitsPerWord);
  }
  unreached[first / LinkBits::kBitsPerWord] ^= std::uint64_t{1} << (first % LinkBits::kBitsPerWord);
  frontier[first / LinkBits::kBitsPerWord] = std::uint64_t{1} << (first % LinkBits::kBitsPerWord);
  hops[first] = 0;
  for (std::int32_t hop = 1, found = 1; found > 0; ++hop) {
    std::fill(next.begin(), next.end(), 0);
    ForEachBit(frontier, [&](int robot) {
      const std::uint64_t* const row = links.Row(robot);
      std::uint64_t missing = 0;
      for (std::size_t w = 0; w < num_words; ++w) {
        next[w] |= row[w] & unreached[w];
        missing |= unreached[w] ^ next[w];
      }
      return missing != 0;  // most teams are found long before the last of the frontier
    });
    found = 0;
    ForEachBit(next, [&](int robot) {
      hops[robot] = hop;
      ++found;
      return true;
    });
    for (std::size_t w = 0; w < num_words; ++w) unreached[w] ^= next[w];
    frontier.swap(next);
  }
}

}  // namespace

HopCount CountHops(const Eigen::Ref<const Adjacency>& adjacency) {
  const LinkBits links(adjacency);
  const int n = links.NumRobots();
  HopCount hops = HopCount::Constant(n, n, -1);
  for (int robot = 0; robot < n; ++robot) SearchFrom(links, robot, &hops(robot, 0));
  return hops;
}

}  // namespace robotteamsim::network
