#include "robotteamsim/plan/disc_fill.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace robotteamsim::plan {
namespace {

constexpr int kBits = 64;
/// A middle nearer than this to the rim may be on either side of it [cells]; many times the largest rounding error.
constexpr double kDoubt = 1e-4;

/// Returns the floor of a value that is at least -kBits.
int Floor(double value) { return static_cast<int>(value + kBits) - kBits; }

bool IsDoubtful(double value) { return std::abs(value - Floor(value + 0.5)) < kDoubt; }

/// Returns the runs of set bits in `open` that contain a bit of `seeds`, a subset of `open`.
std::uint64_t RunsWith(std::uint64_t seeds, std::uint64_t open) {
  std::uint64_t up = seeds, down = seeds, open_up = open, open_down = open;
  for (int shift = 1; shift < kBits; shift *= 2) {
    up |= open_up & (up << shift);
    down |= open_down & (down >> shift);
    open_up &= open_up << shift;
    open_down &= open_down >> shift;
  }
  return up | down;
}

/// Returns the bits `first` to `last`; none if last < first.
std::uint64_t Between(int first, int last) {
  return last < first ? 0 : (~std::uint64_t{0} >> (kBits - 1 - (last - first))) << first;
}

}  // namespace

DiscFill::DiscFill(int rows, int cols, const std::vector<std::uint8_t>& blocked)
    : rows_(rows), cols_(cols), words_((cols + kBits - 1) / kBits + 1) {
  free_.assign(static_cast<std::size_t>(rows_) * words_, 0);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      if (blocked[static_cast<std::size_t>(row) * cols + col] != 0) continue;
      free_[static_cast<std::size_t>(row) * words_ + col / kBits] |= std::uint64_t{1} << (col % kBits);
    }
  }
}

/// Returns which of the 64 cells of a row from `first_col` (above -64) on are free.
std::uint64_t DiscFill::FreeCells(int row, int first_col) const {
  const std::uint64_t* const words = free_.data() + static_cast<std::size_t>(row) * words_;
  if (first_col < 0) return words[0] << -first_col;
  const int word = first_col / kBits, shift = first_col % kBits;
  return shift == 0 ? words[word] : words[word] >> shift | words[word + 1] << (kBits - shift);
}

bool DiscFill::Reach(const Disc& disc, int start_row, int start_col, std::vector<Row>* reached) const {
  reached->clear();
  if (!(disc.radius < 0.5 * kBits - 2.0)) return false;
  const int reach = static_cast<int>(disc.radius) + 1;
  const int first_row = std::max(0, start_row - reach), last_row = std::min(rows_ - 1, start_row + reach);
  const int first_col = start_col - reach;
  std::array<std::uint64_t, kBits> open{};
  for (int row = first_row; row <= last_row; ++row) {
    const double dy = row + 0.5 - disc.center.y;
    const double square = disc.radius * disc.radius - dy * dy;
    if (std::abs(square) < kDoubt) return false;
    if (square > 0.0) {
      const double half = std::sqrt(square);
      const double left = disc.center.x - half - 0.5 - first_col, right = disc.center.x + half - 0.5 - first_col;
      if (IsDoubtful(left) || IsDoubtful(right)) return false;
      // Neither value is a whole number.
      const int first = std::max(0, Floor(left) + 1), last = std::min(kBits - 1, Floor(right));
      open[row - first_row] = FreeCells(row, first_col) & Between(first, last);
    }
    reached->push_back({row, first_col, 0});
  }
  const int num_rows = static_cast<int>(reached->size()), start = start_row - first_row;
  const std::uint64_t start_bit = std::uint64_t{1} << (start_col - first_col);
  std::vector<Row>& rows = *reached;
  rows[start].cells = RunsWith(start_bit, open[start] | start_bit);
  const auto spread = [&](int from, int to) {
    const std::uint64_t seeds = rows[from].cells & open[to] & ~rows[to].cells;
    if (seeds != 0) rows[to].cells |= RunsWith(seeds, open[to]);
    return seeds != 0;
  };
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (int i = 1; i < num_rows; ++i) has_grown |= spread(i - 1, i);
    for (int i = num_rows - 1; i > 0; --i) has_grown |= spread(i, i - 1);
  }
  return true;
}

}  // namespace robotteamsim::plan
