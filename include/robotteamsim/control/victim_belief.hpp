#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "robotteamsim/control/cell_paths.hpp"
#include "robotteamsim/control/voice_losses.hpp"

namespace robotteamsim::control {

/// A place to listen at: the expected share of the victims that is newly heard there, and its rate per second.
struct ListeningPlace {
  int cell = CellPaths::kNone;
  double gain = 0.0;
  double rate_per_s = 0.0;
};

/// What one robot believes about the places of victims that nobody has heard.
///
/// For each cell it stores the smallest loss of a voice on the way to any place where the team listened in vain. A
/// voice that is too faint for that loss may still be there. The smallest of several losses does not depend on their
/// order or on repetitions, so robots may learn of the same listening twice, or late.
class VictimBelief {
 public:
  static constexpr int kNumLosses = 256;
  using Unheard = std::array<float, kNumLosses>;

  /// Args: prior: probability of each cell, >= 0.
  /// Throws std::invalid_argument if `prior` does not fit the losses.
  VictimBelief(std::shared_ptr<const VoiceLosses> losses, std::vector<float> prior);

  /// Uses other losses from now on, because a door has changed. What was heard before stays valid.
  void SetLosses(std::shared_ptr<const VoiceLosses> losses);

  /// Sets the probability that a voice is not heard, for each loss.
  /// Throws std::invalid_argument if one is not from 0 to 1.
  void SetUnheard(const Unheard& unheard);

  /// Notes that no voice was heard at a cell that is louder than `above` steps over the noise.
  /// Throws std::invalid_argument if there is no such cell, or above < 0.
  void Listen(int cell, int above);

  /// Returns the sum of `Mass`: the probability that a victim of the prior is still unheard.
  double Remaining() const;

  /// Returns the probability of each cell.
  std::vector<float> Mass() const;

  /// What a robot plans to do, and what its team does.
  struct Plan {
    std::vector<int> claims;  ///< cells at which teammates will listen
    double speed_mps = 0.0;
    double delay_s = 0.0;  ///< added to each travel time
  };

  /// Returns the candidate with the highest gain per second; nothing if no candidate has any gain.
  std::optional<ListeningPlace> Best(const CellPaths& paths, int start, const std::vector<int>& candidates,
                                     const Plan& plan) const;

  /// Returns gain and rate of listening at one cell.
  ListeningPlace Worth(const CellPaths& paths, int start, int cell, const Plan& plan) const;

 private:
  static constexpr int kLevels = 4;
  class Sums;
  struct Window;

  void FindReach();
  Window All() const;
  Window Around(int cell) const;
  void CheckCell(int cell) const;
  void CheckPlan(const CellPaths& paths, const Plan& plan) const;
  std::vector<float> Unclaimed(const std::vector<int>& claims, const Window& window) const;
  double Most(const Sums& sums, int cell) const;
  double Gain(const std::vector<float>& left, int cell) const;

  std::shared_ptr<const VoiceLosses> losses_;
  std::vector<float> prior_;
  std::vector<std::uint8_t> least_;
  Unheard unheard_{};
  int reach_ = 0;  ///< farther away, in rows or columns, no voice is heard
  /// Number of columns, by rows apart, in which a voice without walls is heard with a probability above i / kLevels.
  std::vector<std::array<int, kLevels>> spans_;
};

}  // namespace robotteamsim::control
