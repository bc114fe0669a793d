#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace robotteamsim::network {

/// A of eq. (17): whether robot i and robot j have a direct link.
using Adjacency = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "bits are collected from bytes, lowest first");

/// The links of a team as bits: robot j is bit j % 64 of word j / 64 in the row of robot i. Bits beyond the team are 0.
class LinkBits {
 public:
  static constexpr int kBitsPerWord = 64;

  /// Throws std::invalid_argument if the matrix is not square, or not symmetric, or its diagonal is not zero.
  explicit LinkBits(const Eigen::Ref<const Adjacency>& adjacency);

  int NumRobots() const { return num_robots_; }

  /// Number of words in a row.
  int NumWords() const { return num_words_; }

  /// Number of links of a robot.
  int Degree(int robot) const;

  /// Returns whether every robot has a path to every other.
  bool IsConnected() const;

  const std::uint64_t* Row(int robot) const { return &words_[static_cast<std::size_t>(robot) * num_words_]; }

 private:
  void SetRow(int robot, const bool* links);
  void CheckDiagonal() const;
  void CheckSymmetry() const;

  int num_robots_;
  int num_words_;
  std::vector<std::uint64_t> words_;
};

/// The neighbours of each robot, ascending: robots[start[i]] .. robots[start[i + 1] - 1] for robot i.
struct Neighbors {
  explicit Neighbors(const LinkBits& links);

  int Count(int robot) const { return start[robot + 1] - start[robot]; }

  std::vector<std::int32_t> start;
  std::vector<std::int32_t> robots;
};

}  // namespace robotteamsim::network
