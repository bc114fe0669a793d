#include "robotteamsim/control/victim_belief.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::control {
namespace {

/// Cells with less probability than this are not counted in gains.
constexpr float kNegligible = 1e-9F;

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

class VictimBelief::Weights {
 public:
  Weights(std::vector<float> cells, int rows, int cols)
      : cells_(std::move(cells)), cols_(cols), sums_(static_cast<std::size_t>(rows + 1) * (cols + 1), 0.0) {
    for (int row = 0; row < rows; ++row) {
      double in_row = 0.0;
      for (int col = 0; col < cols; ++col) {
        in_row += cells_[static_cast<std::size_t>(row) * cols + col];
        Sum(row + 1, col + 1) = Sum(row, col + 1) + in_row;
      }
    }
  }

  const std::vector<float>& cells() const { return cells_; }

  /// Returns the sum over rows [row, row_end) and columns [col, col_end).
  double Within(int row, int row_end, int col, int col_end) const {
    return At(row_end, col_end) - At(row, col_end) - At(row_end, col) + At(row, col);
  }

 private:
  double& Sum(int row, int col) { return sums_[static_cast<std::size_t>(row) * (cols_ + 1) + col]; }
  double At(int row, int col) const { return sums_[static_cast<std::size_t>(row) * (cols_ + 1) + col]; }

  std::vector<float> cells_;
  int cols_;
  std::vector<double> sums_;  ///< over all cells below and to the left
};

VictimBelief::Weights VictimBelief::Unclaimed(const std::vector<int>& claims) const {
  std::vector<std::uint8_t> least = least_;
  for (const int claim : claims) {
    CheckCell(claim);
    const std::vector<std::uint8_t>& losses = losses_->From(claim);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], losses[i]);
  }
  std::vector<float> cells(least.size());
  for (std::size_t i = 0; i < least.size(); ++i) cells[i] = prior_[i] * unheard_[least[i]];
  return {std::move(cells), losses_->grid().rows, losses_->grid().cols};
}

/// The cells from which a voice may be heard at a cell.
struct VictimBelief::Window {
  int row, row_end, col, col_end;
};

VictimBelief::Window VictimBelief::Around(int cell) const {
  const plan::GridShape& grid = losses_->grid();
  const int row = cell / grid.cols, col = cell % grid.cols;
  return {std::max(row - reach_, 0), std::min(row + reach_ + 1, grid.rows), std::max(col - reach_, 0),
          std::min(col + reach_ + 1, grid.cols)};
}

double VictimBelief::Gain(const Weights& left, int cell) const {
  const std::vector<std::uint8_t>& losses = losses_->From(cell);
  const Window near = Around(cell);
  const int cols = losses_->grid().cols;
  double sum = 0.0;
  for (int row = near.row; row < near.row_end; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * cols;
    float in_row = 0.0F;
    for (std::size_t i = first + near.col; i < first + near.col_end; ++i) {
      in_row += std::max(left.cells()[i] - prior_[i] * unheard_[losses[i]], 0.0F);
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
  const Weights left = Unclaimed(plan.claims);
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
    const Window near = Around(cell);
    const double most = left.Within(near.row, near.row_end, near.col, near.col_end);
    if (most > kNegligible) open.push_back({cell, time_s, most / time_s});
  }
  std::sort(open.begin(), open.end(), [](const Candidate& a, const Candidate& b) {
    return a.most_per_s != b.most_per_s ? a.most_per_s > b.most_per_s : a.cell < b.cell;
  });
  std::optional<ListeningPlace> best;
  for (const Candidate& candidate : open) {
    if (best && candidate.most_per_s <= best->rate_per_s) break;
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
  const double gain = Gain(Unclaimed(plan.claims), cell);
  return {cell, gain, gain / (length / plan.speed_mps + plan.delay_s)};
}

}  // namespace robotteamsim::control
