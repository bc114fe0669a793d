#include "robotteamsim/network/link_bits.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>

namespace robotteamsim::network {
namespace {

constexpr int kWordBits = LinkBits::kBitsPerWord;
using Tile = std::array<std::uint64_t, kWordBits>;

std::string Pair(int i, int j) { return "(" + std::to_string(i) + ", " + std::to_string(j) + ")"; }

/// Swaps rows and columns of 64 x 64 bits: halves first, then halves of halves [warren2013].
void Transpose(Tile* tile) {
  std::uint64_t low_half = 0x00000000FFFFFFFF;
  for (int size = kWordBits / 2; size > 0; size /= 2, low_half ^= low_half << size) {
    for (int i = 0; i < kWordBits; ++i) {
      if (i & size) continue;
      const std::uint64_t swapped = (((*tile)[i] >> size) ^ (*tile)[i + size]) & low_half;
      (*tile)[i] ^= swapped << size;
      (*tile)[i + size] ^= swapped;
    }
  }
}

}  // namespace

LinkBits::LinkBits(const Eigen::Ref<const Adjacency>& adjacency) : num_robots_(static_cast<int>(adjacency.rows())) {
  if (adjacency.cols() != num_robots_) {
    throw std::invalid_argument("adjacency must be square, got shape " +
                                Pair(num_robots_, static_cast<int>(adjacency.cols())));
  }
  num_words_ = (num_robots_ + kWordBits - 1) / kWordBits;
  words_.assign(static_cast<std::size_t>(num_robots_) * num_words_, 0);
  for (int i = 0; i < num_robots_; ++i) SetRow(i, adjacency.data() + i * adjacency.outerStride());
  CheckDiagonal();
  CheckSymmetry();
}

int LinkBits::Degree(int robot) const {
  int degree = 0;
  for (int w = 0; w < num_words_; ++w) degree += __builtin_popcountll(Row(robot)[w]);
  return degree;
}

bool LinkBits::IsConnected() const {
  if (num_robots_ == 0) return true;
  std::vector<std::uint64_t> reached(num_words_, 0);
  std::vector<std::uint64_t> visited(num_words_, 0);
  reached[0] = 1;
  int num_visited = 0;
  for (bool found = true; found;) {
    found = false;
    for (int w = 0; w < num_words_; ++w) {
      for (std::uint64_t bits; (bits = reached[w] & ~visited[w]) != 0; found = true) {
        visited[w] |= bits & -bits;
        ++num_visited;
        const std::uint64_t* const row = Row(w * kWordBits + __builtin_ctzll(bits));
        for (int v = 0; v < num_words_; ++v) reached[v] |= row[v];
      }
    }
  }
  return num_visited == num_robots_;
}

void LinkBits::SetRow(int robot, const bool* links) {
  std::uint64_t* const row = &words_[static_cast<std::size_t>(robot) * num_words_];
  int j = 0;
  for (; j + 8 <= num_robots_; j += 8) {
    std::uint64_t bytes;  // each 0 or 1; the product collects them in its highest byte
    std::memcpy(&bytes, links + j, sizeof bytes);
    row[j / kWordBits] |= (bytes * 0x0102040810204080 >> 56) << (j % kWordBits);
  }
  for (; j < num_robots_; ++j) row[j / kWordBits] |= static_cast<std::uint64_t>(links[j]) << (j % kWordBits);
}

void LinkBits::CheckDiagonal() const {
  for (int i = 0; i < num_robots_; ++i) {
    if (Row(i)[i / kWordBits] >> (i % kWordBits) & 1) {
      throw std::invalid_argument("adjacency must be 0 on the diagonal, got 1 at " + Pair(i, i));
    }
  }
}

void LinkBits::CheckSymmetry() const {
  for (int top = 0; top < num_robots_; top += kWordBits) {
    for (int left = 0; left <= top; left += kWordBits) {
      Tile tile{};
      for (int i = top; i < std::min(top + kWordBits, num_robots_); ++i) tile[i - top] = Row(i)[left / kWordBits];
      Transpose(&tile);
      for (int j = left; j < std::min(left + kWordBits, num_robots_); ++j) {
        const std::uint64_t different = tile[j - left] ^ Row(j)[top / kWordBits];
        if (different == 0) continue;
        const int i = top + __builtin_ctzll(different);
        throw std::invalid_argument("adjacency must be symmetric, but is not at " +
                                    Pair(std::min(i, j), std::max(i, j)));
      }
    }
  }
}

Neighbors::Neighbors(const LinkBits& links) {
  const int n = links.NumRobots();
  start.push_back(0);
  for (int i = 0; i < n; ++i) {
    start.push_back(start.back() + links.Degree(i));
  }
  robots.resize(start.back());
  std::int32_t* next = robots.data();
  for (int i = 0; i < n; ++i) {
    for (int w = 0; w < links.NumWords(); ++w) {
      for (std::uint64_t bits = links.Row(i)[w]; bits != 0; bits &= bits - 1) {
        *next++ = w * kWordBits + __builtin_ctzll(bits);
      }
    }
  }
}

}  // namespace robotteamsim::network
