#include "robotteamsim/control/voice_fix.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "robotteamsim/base/checks.hpp"
#include "robotteamsim/base/log10.hpp"
#include "robotteamsim/propagation/cells.hpp"

namespace robotteamsim::control {
namespace {

/// Standard deviation of a level for a known place: walls that only part of a cell is behind [dB].
constexpr double kLevelDeviation = 1.0;
/// Distance of a victim from the centre of their cell, in cells: the standard deviation along one axis.
constexpr double kOffCenter = 0.29;
constexpr float kLeastPrior = 1e-30F;
constexpr double kSmallProduct = 1e-100;
constexpr double kLn10 = 2.302585092994046;

Spread CheckedSpread(const Spread& spread, const char* name) {
  base::Check(spread.mean, name);
  base::CheckPositive(spread.deviation, name);
  return spread;
}

double Ln(double value) { return kLn10 * base::Log10(value); }

}  // namespace

VoiceFix::VoiceFix(std::shared_ptr<const VoiceLosses> losses, const Spread& loudness_db, const Spread& exponent)
    : losses_(std::move(losses)),
      loudness_db_(CheckedSpread(loudness_db, "loudness_db")),
      exponent_(CheckedSpread(exponent, "exponent")) {
  if (losses_ == nullptr) throw std::invalid_argument("a fix needs losses");
  sums_.resize(losses_->Size());
}

void VoiceFix::Add(const base::Point& place, double level_db) {
  base::Check(place, "place_m");
  base::Check(level_db, "level_db");
  const std::vector<float> walls_db = losses_->WallsFromDb(place);
  const plan::GridShape& grid = losses_->grid();
  const double least_m = std::max(losses_->fading().min_distance_m, kOffCenter * grid.resolution_m);
  const double least_square = least_m * least_m;
  // The loss grows by this per metre at a distance of 1 m.
  const double grows_db = 10.0 * exponent_.mean / kLn10 * kOffCenter * grid.resolution_m;
  // Distances and weights of a row come first: a loop without a branch is vectorised.
  std::vector<double> distances_db(grid.cols), weights(grid.cols);
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const base::Point center = propagation::CellCenter(grid, row, col);
      const double away_x = center.x - place.x, away_y = center.y - place.y;
      const double square = std::max(away_x * away_x + away_y * away_y, least_square);
      weights[col] = square / (kLevelDeviation * kLevelDeviation * square + grows_db * grows_db);
      distances_db[col] = 5.0 * base::Log10(square);
    }
    for (int col = 0; col < grid.cols; ++col) {
      const std::size_t cell = static_cast<std::size_t>(row) * grid.cols + col;
      const double w = weights[col], x = distances_db[col];
      const double r = level_db + walls_db[cell] - loudness_db_.mean + exponent_.mean * x;
      Sums& sums = sums_[cell];
      sums.w += w;
      sums.wx += w * x;
      sums.wxx += w * x * x;
      sums.wr += w * r;
      sums.wxr += w * x * r;
      sums.wrr += w * r * r;
      sums.w_product *= w;
      if (sums.w_product < kSmallProduct) {  // a logarithm now and then, instead of one per level
        sums.log_w += Ln(sums.w_product);
        sums.w_product = 1.0;
      }
    }
  }
  ++count_;
}

std::optional<VoiceFix::Source> VoiceFix::MostProbable(const std::vector<float>& prior) const {
  if (prior.size() != sums_.size()) {
    throw std::invalid_argument("prior must have " + std::to_string(sums_.size()) + " cells, got " +
                                std::to_string(prior.size()));
  }
  if (count_ == 0) return std::nullopt;
  const double of_loudness = 1.0 / (loudness_db_.deviation * loudness_db_.deviation);
  const double of_exponent = 1.0 / (exponent_.deviation * exponent_.deviation);
  std::optional<Source> best;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < prior.size(); ++i) {
    if (!(prior[i] > kLeastPrior)) continue;
    const Sums& s = sums_[i];
    // The precision of (loudness, exponent), a symmetric matrix, and its inverse in closed form.
    const double p11 = s.w + of_loudness, p12 = -s.wx, p22 = s.wxx + of_exponent;
    const double determinant = p11 * p22 - p12 * p12;
    if (!(determinant > 0.0)) continue;  // rounding
    const double explained = (p22 * s.wr * s.wr + 2.0 * p12 * s.wr * s.wxr + p11 * s.wxr * s.wxr) / determinant;
    const double misfit = std::max(s.wrr - explained, 0.0);
    const double evidence = 0.5 * (s.log_w - misfit + Ln(prior[i] * prior[i] * s.w_product / determinant));
    if (evidence > highest) {
      highest = evidence;
      best = Source{static_cast<int>(i), misfit / count_};
    }
  }
  return best;
}

}  // namespace robotteamsim::control
