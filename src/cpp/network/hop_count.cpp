#include "robotteamsim/network/hop_count.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "robotteamsim/base/mirror.hpp"

namespace robotteamsim::network {
namespace {

constexpr int kBits = LinkBits::kBitsPerWord;
constexpr int kWords = LinkBits::kWordsPerBlock;
constexpr int kSources = kBits * kWords;

/// If robots are farther apart than this, one search after the other is faster: in a common search each hop costs the
/// same, however few robots it finds.
constexpr int kManyHops = 100;

/// Number of hops that are stored before they are counted; below 256, so that a count fits a byte.
constexpr int kKeptHops = 32;

/// Number of neighbours between two checks whether a robot is reached from all sources.
constexpr int kNeighborsPerLook = 8;

/// A bit per source of a block.
struct SourceSet {
  std::uint64_t words[kWords];
};

/// Returns, for each value of a byte, its eight bits as eight bytes.
std::array<std::uint64_t, 256> MakeBitsAsBytes() {
  std::array<std::uint64_t, 256> table{};
  for (int value = 0; value < 256; ++value) {
    std::uint8_t bytes[8];
    for (int bit = 0; bit < 8; ++bit) bytes[bit] = value >> bit & 1;
    std::memcpy(&table[value], bytes, sizeof bytes);
  }
  return table;
}

/// Adds the hops during which a source had not yet reached a robot to its row, which is empty before the first count.
void AddHops(const std::uint8_t* __restrict times_reached, int hops, int num_sources, int counted_before,
             std::int32_t* __restrict row) {
  if (counted_before == 0) {
    for (int i = 0; i < num_sources; ++i) row[i] = 1 + hops - times_reached[i];
  } else {
    for (int i = 0; i < num_sources; ++i) row[i] += hops - times_reached[i];
  }
}

/// Breadth-first search from all robots of one block at once.
class BlockSearch {
 public:
  BlockSearch(const LinkBits& links, const Neighbors& neighbors)
      : links_(links),
        neighbors_(neighbors),
        num_robots_(links.NumRobots()),
        bits_as_bytes_(MakeBitsAsBytes()),
        reached_(static_cast<std::size_t>(num_robots_) * (kKeptHops + 1)) {}

  /// Fills the columns of the block that begins with first_source, from the diagonal upward.
  void Run(int first_source, HopCount* hops) {
    Start(first_source);
    counted_ = 0;
    int kept = 0;
    while (Hop(Reached(kept), Reached(kept + 1))) {
      if (++kept < kKeptHops) continue;
      Count(kept, hops);
      std::copy_n(Reached(kept), num_robots_, Reached(0));
      kept = 0;
    }
    Count(kept, hops);
    Finish(Reached(kept), hops);
  }

 private:
  /// The sources that have reached each robot after the k-th stored hop.
  SourceSet* Reached(int k) { return &reached_[static_cast<std::size_t>(k) * num_robots_]; }

  void Start(int first_source) {
    first_source_ = first_source;
    num_sources_ = std::min(kSources, num_robots_ - first_source);
    all_ = SourceSet{};
    for (int i = 0; i < num_sources_; ++i) all_.words[i / kBits] |= std::uint64_t{1} << (i % kBits);
    for (int robot = 0; robot < num_robots_; ++robot) {
      std::copy_n(links_.Row(robot) + first_source / kBits, kWords, Reached(0)[robot].words);
    }
    for (int i = 0; i < num_sources_; ++i) {
      Reached(0)[first_source + i].words[i / kBits] |= std::uint64_t{1} << (i % kBits);
    }
  }

  /// Advances by one hop; returns whether any source has reached another robot.
  bool Hop(const SourceSet* __restrict before, SourceSet* __restrict after) const {
    const SourceSet all = all_;
    const std::int32_t* const start = neighbors_.start.data();
    const std::int32_t* const robots = neighbors_.robots.data();
    std::uint64_t new_bits = 0;
    for (int robot = 0; robot < num_robots_; ++robot) {
      std::uint64_t found[kWords];
      std::copy_n(before[robot].words, kWords, found);
      const auto is_complete = [&] {
        std::uint64_t missing = 0;
        for (int w = 0; w < kWords; ++w) missing |= all.words[w] & ~found[w];
        return missing == 0;
      };
      const std::int32_t end = start[robot + 1];
      for (std::int32_t e = start[robot]; e < end && !is_complete();) {
        for (const std::int32_t look = std::min(e + kNeighborsPerLook, end); e < look; ++e) {
          const SourceSet& neighbor = before[robots[e]];
          for (int w = 0; w < kWords; ++w) found[w] |= neighbor.words[w];
        }
      }
      for (int w = 0; w < kWords; ++w) {
        new_bits |= found[w] ^ before[robot].words[w];
        after[robot].words[w] = found[w];
      }
    }
    return new_bits != 0;
  }

  /// Counts for every pair the stored hops after which the source had not reached the robot.
  void Count(int kept, HopCount* hops) {
    for (int robot = 0; robot < first_source_ + num_sources_; ++robot) {
      std::uint8_t times_reached[kSources];
      for (int w = 0; w < kWords; ++w) {
        std::uint64_t counts[8] = {};  // for eight sources each
        for (int k = 0; k < kept; ++k) {
          const std::uint64_t word = Reached(k)[robot].words[w];
          for (int byte = 0; byte < 8; ++byte) counts[byte] += bits_as_bytes_[word >> 8 * byte & 0xFF];
        }
        std::memcpy(times_reached + std::ptrdiff_t{w} * kBits, counts, sizeof counts);
      }
      AddHops(times_reached, kept, num_sources_, counted_, &(*hops)(robot, first_source_));
    }
    counted_ += kept;
  }

  void Finish(const SourceSet* reached, HopCount* hops) const {
    for (int robot = 0; robot < first_source_ + num_sources_; ++robot) {
      for (int w = 0; w < kWords; ++w) {
        for (std::uint64_t bits = all_.words[w] & ~reached[robot].words[w]; bits != 0; bits &= bits - 1) {
          (*hops)(robot, first_source_ + w * kBits + __builtin_ctzll(bits)) = -1;
        }
      }
    }
    for (int i = first_source_; i < first_source_ + num_sources_; ++i) (*hops)(i, i) = 0;
  }

  const LinkBits& links_;
  const Neighbors& neighbors_;
  const int num_robots_;
  const std::array<std::uint64_t, 256> bits_as_bytes_;
  std::vector<SourceSet> reached_;
  int first_source_ = 0;
  int num_sources_ = 0;
  int counted_ = 0;  // number of hops of the search
  SourceSet all_{};
};

/// Returns the greatest number of hops from the first robot of a component to another robot of it: at least half of the
/// longest shortest path.
std::int32_t HopsAcross(const Neighbors& neighbors, int num_robots) {
  std::vector<std::int32_t> hops(num_robots, -1);
  for (int robot = 0; robot < num_robots; ++robot) {
    if (hops[robot] < 0) SearchFrom(neighbors, robot, &hops);
  }
  return *std::max_element(hops.begin(), hops.end());
}

void SearchOneByOne(const Neighbors& neighbors, HopCount* hops) {
  for (Eigen::Index robot = 0; robot < hops->rows(); ++robot) {
    std::vector<std::int32_t> row(hops->cols(), -1);
    SearchFrom(neighbors, static_cast<int>(robot), &row);
    std::copy(row.begin(), row.end(), &(*hops)(robot, 0));
  }
}

}  // namespace

HopCount CountHops(const Eigen::Ref<const Adjacency>& adjacency) {
  const LinkBits links(adjacency);
  const Neighbors neighbors(links);
  const int n = links.NumRobots();
  HopCount hops(n, n);
  if (n == 0) return hops;
  if (HopsAcross(neighbors, n) > kManyHops) {
    SearchOneByOne(neighbors, &hops);
    return hops;
  }
  BlockSearch search(links, neighbors);
  for (int first_source = 0; first_source < n; first_source += kSources) search.Run(first_source, &hops);
  for (int top = 0; top < n; top += base::kMirroredRows) base::MirrorRows(top, top + base::kMirroredRows, &hops);
  return hops;
}

propagation::CellValues BreakMatrix(const Eigen::Ref<const propagation::CellValues>& link,
                                    const Eigen::Ref<const HopCount>& hops) {
  if (link.rows() != hops.rows() || link.cols() != hops.cols()) {
    throw std::invalid_argument("links and hops must have the same shape");
  }
  return (hops.array() < 0).select(link, 0.0);
}

}  // namespace robotteamsim::network
