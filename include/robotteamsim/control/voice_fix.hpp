#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/control/voice_losses.hpp"

namespace robotteamsim::control {

/// The range of a quantity: its mean and standard deviation.
struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
};

/// Where the voice that a robot hears comes from, given the levels that it measured.
///
/// For each cell, the levels are a linear regression on 10 log10(d): loudness minus exponent times distance, minus the
/// walls. Loudness and exponent have normal priors, so the evidence of a cell has a closed form.
class VoiceFix {
 public:
  /// Args: loudness_db: -l_c of victims.  exponent: gamma.
  /// Throws std::invalid_argument if a number cannot be used.
  VoiceFix(std::shared_ptr<const VoiceLosses> losses, const Spread& loudness_db, const Spread& exponent);

  /// Adds a measured level. Throws std::invalid_argument if a number is not finite.
  void Add(const base::Point& place, double level_db);

  int Count() const { return count_; }

  /// Where the victim probably is.
  struct Source {
    int cell = -1;
    double misfit = 0.0;  ///< chi squared per level: far above 1 if no single voice explains the levels
  };

  /// Returns the cell with the highest probability; nothing without a level.
  /// Args: prior: of each cell, >= 0; cells of 0 are left out. Throws std::invalid_argument if it has another length.
  std::optional<Source> MostProbable(const std::vector<float>& prior) const;

 private:
  /// Weighted sums of one cell: x is 10 log10(d), r the level above that of a middling voice.
  struct Sums {
    double w = 0.0, wx = 0.0, wxx = 0.0, wr = 0.0, wxr = 0.0, wrr = 0.0, log_w = 0.0, w_product = 1.0;
  };

  std::shared_ptr<const VoiceLosses> losses_;
  Spread loudness_db_, exponent_;
  std::vector<Sums> sums_;
  int count_ = 0;
};

}  // namespace robotteamsim::control
