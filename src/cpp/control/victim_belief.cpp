#include "robotteamsim/control/victim_belief.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::control {
namespace {

/// Cells with less probability than this are not counted in gains.
constexpr float kNegligible = 1e-9F;
/// More than the rounding errors of a gain: relative, and absolute.
constexpr double kRelativeMargin = 1.0 + 1e-5, kMargin = 1e-7;

}  // namespace

VictimBelief::VictimBelief(std::shared_ptr<const VoiceLosses> losses, std::vector<float> prior)
    : losses_(std::move(losses)), prior_(std::move(prior)) {
  if (losses_ == nullptr) throw std::invalid_argument("a belief needs losses");
  if (prior_.size() != losses_->Size()) {
    throw std::invalid_argument("prior must have " + std::to_string(losses_->Size()) + " cells, got " +
                                std::to_string(prior_.size()));
  }
  for (const float share : prior_) base::CheckNotNegative(share, "prior");
  least_.assign(prior_.size(), VoiceLosses::kSilent);
  unheard_.fill(1.0F);
  FindReach();
}

void VictimBelief::SetLosses(std::shared_ptr<const VoiceLosses> losses) {
  if (losses == nullptr || losses->Size() != prior_.size()) {
    throw std::invalid_argument("losses must be those of the same grid");
  }
  losses_ = std::move(losses);
  FindReach();
}

void VictimBelief::SetUnheard(const Unheard& unheard) {
  for (const float share : unheard) {
    if (!(share >= 0.0F && share <= 1.0F)) throw std::invalid_argument("unheard must be from 0 to 1");
  }
  unheard_ = unheard;
  FindReach();
}

void VictimBelief::FindReach() {
  int loss = 0;
  while (loss < VoiceLosses::kSilent && unheard_[loss] < 1.0F) ++loss;
  reach_ = losses_->ReachOf(loss);
  std::array<float, kNumLosses> heard{};  // the probability that a voice is heard after a loss, or a larger one
  float most = 0.0F;
  for (int i = kNumLosses - 1; i >= 0; --i) heard[i] = most = std::max(most, 1.0F - unheard_[i]);
  const int most_rows = std::min(reach_ + 1, losses_->grid().rows),
            most_cols = std::min(reach_ + 1, losses_->grid().cols);
  spans_.assign(most_rows, {});
  for (int rows = 0; rows < most_rows; ++rows) {
    for (int level = 0; level < kLevels; ++level) {
      int cols = 0;
      while (cols < most_cols && heard[losses_->WithoutWalls(rows, cols)] * kLevels > static_cast<float>(level)) ++cols;
      spans_[rows][level] = cols;
    }
  }
}

void VictimBelief::CheckCell(int cell) const {
  if (cell < 0 || static_cast<std::size_t>(cell) >= prior_.size()) {
    throw std::invalid_argument("there is no cell " + std::to_string(cell));
  }
}

void VictimBelief::Listen(int cell, int above) {
  CheckCell(cell);
  if (above < 0) throw std::invalid_argument("above must be >= 0, got " + std::to_string(above));
  const std::vector<std::uint8_t>& losses = losses_->From(cell);
  const int more = std::min<int>(above, VoiceLosses::kSilent);
  for (std::size_t i = 0; i < least_.size(); ++i) {
    const int loss = std::min<int>(losses[i] + more, VoiceLosses::kSilent);
    least_[i] = std::min<std::uint8_t>(least_[i], static_cast<std::uint8_t>(loss));
  }
}

double VictimBelief::Remaining() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < prior_.size(); ++i) sum += static_cast<double>(prior_[i]) * unheard_[least_[i]];
  return sum;
}

std::vector<float> VictimBelief::Mass() const {
  std::vector<float> mass(prior_.size());
  for (std::size_t i = 0; i < prior_.size(); ++i) mass[i] = prior_[i] * unheard_[least_[i]];
  return mass;
}

/// A rectangle of cells.
struct VictimBelief::Window {
  int row, row_end, col, col_end;
};

VictimBelief::Window VictimBelief::All() const { return {0, losses_->grid().rows, 0, losses_->grid().cols}; }

/// The cells from which a voice may be heard at a cell.
VictimBelief::Window VictimBelief::Around(int cell) const {
  const plan::GridShape& grid = losses_->grid();
  const int row = cell / grid.cols, col = cell % grid.cols;
  return {std::max(row - reach_, 0), std::min(row + reach_ + 1, grid.rows), std::max(col - reach_, 0),
          std::min(col + reach_ + 1, grid.cols)};
}

/// Returns the probability of each cell in a window after the claims, and 0 for the others.
std::vector<float> VictimBelief::Unclaimed(const std::vector<int>& claims, const Window& window) const {
  for (const int claim : claims) CheckCell(claim);
  const int cols = losses_->grid().cols, width = window.col_end - window.col;
  std::vector<float> left(least_.size());
  std::vector<std::uint8_t> least(width);
  for (int row = window.row; row < window.row_end; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * cols + window.col;
    std::copy_n(&least_[first], width, least.data());
    for (const int claim : claims) {
      const std::uint8_t* const losses = &losses_->From(claim)[first];
      for (int i = 0; i < width; ++i) least[i] = std::min(least[i], losses[i]);
    }
    for (int i = 0; i < width; ++i) left[first + i] = prior_[first + i] * unheard_[least[i]];
  }
  return left;
}

/// Sums over rectangles of cells.
class VictimBelief::Sums {
 public:
  Sums(const std::vector<float>& cells, const plan::GridShape& grid)
      : stride_(grid.cols + 1), sums_(static_cast<std::size_t>(grid.rows + 1) * stride_, 0.0) {
    std::size_t cell = 0;
    for (int row = 0; row < grid.rows; ++row) {
      const double* const below = &sums_[row * stride_];
      double* const sums = &sums_[(row + 1) * stride_];
      double in_row = 0.0;
      for (int col = 0; col < grid.cols; ++col) {
        in_row += cells[cell++];
        sums[col + 1] = below[col + 1] + in_row;
      }
    }
  }

  double Within(const Window& window) const {
    return At(window.row_end, window.col_end) - At(window.row, window.col_end) - At(window.row_end, window.col) +
           At(window.row, window.col);
  }

  double Within(int row, int col, int col_end) const { return Within({row, row + 1, col, col_end}); }

 private:
  double At(int row, int col) const { return sums_[row * stride_ + col]; }

  std::size_t stride_;
  std::vector<double> sums_;  ///< over all cells below and to the left
};

/// Returns a number that no gain at a cell exceeds: what would be heard without walls.
double VictimBelief::Most(const Sums& sums, int cell) const {
  const Window near = Around(cell);
  const int cols = losses_->grid().cols, at_row = cell / cols, at_col = cell % cols;
  double sum = 0.0;
  for (int row = near.row; row < near.row_end; ++row) {
    for (const int span : spans_[std::abs(row - at_row)]) {
      if (span == 0) break;
      sum += sums.Within(row, std::max(at_col - span + 1, 0), std::min(at_col + span, cols));
    }
  }
  return kRelativeMargin * sum / kLevels + kMargin;
}

double VictimBelief::Gain(const std::vector<float>& left, int cell) const {
  const std::vector<std::uint8_t>& losses = losses_->From(cell);
  const Window near = Around(cell);
  const int cols = losses_->grid().cols;
  double sum = 0.0;
  for (int row = near.row; row < near.row_end; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * cols;
    float in_row = 0.0F;
    for (std::size_t i = first + near.col; i < first + near.col_end; ++i) {
      in_row += std::max(left[i] - prior_[i] * unheard_[losses[i]], 0.0F);
    }
    sum += in_row;
  }
  return sum;
}

void VictimBelief::CheckPlan(const CellPaths& paths, const Plan& plan) const {
  base::CheckPositive(plan.speed_mps, "speed_mps");
  base::CheckPositive(plan.delay_s, "delay_s");
  if (paths.Size() != prior_.size()) throw std::invalid_argument("paths must be those of the same grid");
}

std::optional<ListeningPlace> VictimBelief::Best(const CellPaths& paths, int start, const std::vector<int>& candidates,
                                                 const Plan& plan) const {
  CheckPlan(paths, plan);
  const std::vector<float> left = Unclaimed(plan.claims, All());
  const Sums sums(left, losses_->grid());
  const std::vector<float>& lengths = paths.LengthsFrom(start);
  struct Candidate {
    int cell;
    double time_s;
    double most_per_s;  // if all that may be heard were heard
  };
  std::vector<Candidate> open;
  open.reserve(candidates.size());
  for (const int cell : candidates) {
    CheckCell(cell);
    if (!std::isfinite(lengths[cell])) continue;
    const double time_s = lengths[cell] / plan.speed_mps + plan.delay_s;
    const double most = sums.Within(Around(cell));
    if (most > kNegligible) open.push_back({cell, time_s, most / time_s});
  }
  const auto is_worse = [](const Candidate& a, const Candidate& b) {
    return a.most_per_s != b.most_per_s ? a.most_per_s < b.most_per_s : a.cell > b.cell;
  };
  // A heap instead of a sorted list: few candidates are compared.
  std::make_heap(open.begin(), open.end(), is_worse);
  std::optional<ListeningPlace> best;
  while (!open.empty()) {
    const Candidate candidate = open.front();
    if (best && candidate.most_per_s <= best->rate_per_s) break;
    std::pop_heap(open.begin(), open.end(), is_worse);
    open.pop_back();
    if (best && Most(sums, candidate.cell) <= best->rate_per_s * candidate.time_s) continue;
    const double gain = Gain(left, candidate.cell);
    if (gain <= kNegligible || (best && gain <= best->rate_per_s * candidate.time_s)) continue;
    best = ListeningPlace{candidate.cell, gain, gain / candidate.time_s};
  }
  return best;
}

ListeningPlace VictimBelief::Worth(const CellPaths& paths, int start, int cell, const Plan& plan) const {
  CheckPlan(paths, plan);
  CheckCell(start);
  // Paths are as long in the other direction, and those to a goal are known.
  const double length = paths.LengthsFrom(cell)[start];
  if (!std::isfinite(length)) return {cell, 0.0, 0.0};
  const double gain = Gain(Unclaimed(plan.claims, Around(cell)), cell);
  return {cell, gain, gain / (length / plan.speed_mps + plan.delay_s)};
}

}  // namespace robotteamsim::control
