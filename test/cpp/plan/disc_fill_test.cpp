#include "robotteamsim/plan/disc_fill.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace robotteamsim::plan {
namespace {

/// The cells that DiscFill::Reach finds, found one by one.
std::vector<std::uint8_t> PlainReach(const std::vector<std::uint8_t>& blocked, int rows, int cols,
                                     const DiscFill::Disc& disc, int start_row, int start_col) {
  std::vector<std::uint8_t> reached(blocked.size(), 0);
  std::vector<std::pair<int, int>> open{{start_row, start_col}};
  reached[static_cast<std::size_t>(start_row) * cols + start_col] = 1;
  while (!open.empty()) {
    const auto [row, col] = open.back();
    open.pop_back();
    for (const auto& [next_row, next_col] :
         {std::pair{row - 1, col}, std::pair{row + 1, col}, std::pair{row, col - 1}, std::pair{row, col + 1}}) {
      if (next_row < 0 || next_row >= rows || next_col < 0 || next_col >= cols) continue;
      const std::size_t next = static_cast<std::size_t>(next_row) * cols + next_col;
      const double dx = next_col + 0.5 - disc.center.x, dy = next_row + 0.5 - disc.center.y;
      if (reached[next] != 0 || blocked[next] != 0 || dx * dx + dy * dy > disc.radius * disc.radius) continue;
      reached[next] = 1;
      open.emplace_back(next_row, next_col);
    }
  }
  return reached;
}

TEST(DiscFill, ReachesTheCellsThatAPlainSearchReaches) {
  std::mt19937 random(3);  // NOLINT(bugprone-random-generator-seed): the same grids in each run
  const auto uniform = [&](double high) { return std::uniform_real_distribution<double>(0.0, high)(random); };
  std::vector<DiscFill::Row> found;
  int num_found = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int rows = 1 + static_cast<int>(uniform(90.0)), cols = 1 + static_cast<int>(uniform(150.0));
    const double share = uniform(0.5);
    std::vector<std::uint8_t> blocked(static_cast<std::size_t>(rows) * cols);
    for (std::uint8_t& cell : blocked) cell = uniform(1.0) < share ? 1 : 0;
    const DiscFill::Disc disc{{uniform(cols), uniform(rows)}, uniform(29.9)};
    const int row = static_cast<int>(disc.center.y), col = static_cast<int>(disc.center.x);
    blocked[static_cast<std::size_t>(row) * cols + col] = 0;
    if (!DiscFill(rows, cols, blocked).Reach(disc, row, col, &found)) continue;
    ++num_found;
    std::vector<std::uint8_t> reached(blocked.size(), 0);
    for (const DiscFill::Row& part : found) {
      for (int i = 0; i < 64; ++i) {
        if ((part.cells >> i & 1U) == 0) continue;
        ASSERT_TRUE(part.first_col + i >= 0 && part.first_col + i < cols);
        reached[static_cast<std::size_t>(part.row) * cols + part.first_col + i] = 1;
      }
    }
    ASSERT_EQ(reached, PlainReach(blocked, rows, cols, disc, row, col)) << "trial " << trial;
  }
  EXPECT_GT(num_found, 350);
}

TEST(DiscFill, LeavesItToOthersWhereRoundingWouldDecideAndWhereTheDiscIsTooWide) {
  const DiscFill fill(64, 64, std::vector<std::uint8_t>(64UL * 64UL, 0));
  std::vector<DiscFill::Row> found;
  EXPECT_FALSE(fill.Reach({{20.5, 20.5}, 5.0}, 20, 20, &found));
  EXPECT_TRUE(fill.Reach({{20.6, 20.7}, 5.05}, 20, 20, &found));
  EXPECT_FALSE(fill.Reach({{20.6, 20.7}, 31.0}, 20, 20, &found));
}

}  // namespace
}  // namespace robotteamsim::plan
