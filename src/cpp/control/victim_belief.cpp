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
}

void VictimBelief::SetLosses(std::shared_ptr<const VoiceLosses> losses) {
  if (losses == nullptr || losses->Size() != prior_.size()) {
    throw std::invalid_argument("losses must be those of the same grid");
  }
  losses_ = std::move(losses);
}

void VictimBelief::SetUnheard(const Unheard& unheard) {
  for (const float share : unheard) {
    if (!(share >= 0.0F && share <= 1.0F)) throw std::invalid_argument("unheard must be from 0 to 1");
  }
  unheard_ = unheard;
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

VictimBelief::Weights VictimBelief::Unclaimed(const std::vector<int>& claims) const {
  std::vector<std::uint8_t> least = least_;
  for (const int claim : claims) {
    CheckCell(claim);
    const std::vector<std::uint8_t>& losses = losses_->From(claim);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], losses[i]);
  }
  Weights left;
  for (std::size_t i = 0; i < least.size(); ++i) {
    const float weight = prior_[i] * unheard_[least[i]];
    if (weight <= kNegligible) continue;
    left.cells.push_back(static_cast<int>(i));
    left.weight.push_back(weight);
  }
  return left;
}

double VictimBelief::Gain(const Weights& left, int cell) const {
  const std::vector<std::uint8_t>& losses = losses_->From(cell);
  // Several sums, so that an addition need not wait for the one before.
  std::array<double, 4> sums{};
  for (std::size_t i = 0; i < left.cells.size(); ++i) {
    const int at = left.cells[i];
    const float missed = prior_[at] * unheard_[losses[at]];
    sums[i % sums.size()] += std::max(left.weight[i] - missed, 0.0F);
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

std::optional<ListeningPlace> VictimBelief::Best(const CellPaths& paths, int start, const std::vector<int>& candidates,
                                                 const Plan& plan) const {
  base::CheckPositive(plan.speed_mps, "speed_mps");
  base::CheckPositive(plan.delay_s, "delay_s");
  if (paths.Size() != prior_.size()) throw std::invalid_argument("paths must be those of the same grid");
  const Weights left = Unclaimed(plan.claims);
  double all = 0.0;
  for (const float weight : left.weight) all += weight;
  const std::vector<float>& lengths = paths.LengthsFrom(start);
  std::optional<ListeningPlace> best;
  for (const int cell : candidates) {
    CheckCell(cell);
    if (!std::isfinite(lengths[cell])) continue;
    const double time_s = lengths[cell] / plan.speed_mps + plan.delay_s;
    if (best && all <= best->rate_per_s * time_s) continue;
    const double gain = Gain(left, cell);
    if (gain <= kNegligible || (best && gain <= best->rate_per_s * time_s)) continue;
    best = ListeningPlace{cell, gain, gain / time_s};
  }
  return best;
}

ListeningPlace VictimBelief::Worth(const CellPaths& paths, int start, int cell, const Plan& plan) const {
  return Best(paths, start, {cell}, plan).value_or(ListeningPlace{cell, 0.0, 0.0});
}

}  // namespace robotteamsim::control
