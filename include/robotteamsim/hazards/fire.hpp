#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/hazards/links.hpp"

namespace robotteamsim::hazards {

/// What burns in one cell.
struct Fuel {
  double load_kj = 0.0;       ///< heat of all of it
  double peak_kw = 0.0;       ///< highest heat release rate
  double growth_kw_s2 = 0.0;  ///< of the t-squared fire
};

enum class Burning : std::uint8_t { kNot, kBurns, kBurntOut };

/// A cell that burns, and the heat that it released in the last step [kJ].
struct Release {
  int padded = 0;
  double heat_kj = 0.0;
};

/// Fire that spreads from cell to cell.
///
/// The cell where a fire begins releases growth * t^2, up to its peak, until its load is spent. Any other cell is
/// ignited by the nearest burning cell within three cells that no wall hides, at a rate that depends on the distance
/// and on its own fuel, and releases its peak at once: the growth of a fire is that of its area, and over uniform fuel
/// the whole fire releases growth * t^2. Each cell has a threshold, which is its only random number: it ignites when
/// the rate, added up over time, reaches it; with thresholds of an exponential distribution of mean 1, the rate is a
/// probability per time.
class Fire {
 public:
  /// Args: fuels: kinds of fuel.  fuel_of_cell: per cell, the kind; -1 for none.  thresholds: per cell.
  /// Throws std::invalid_argument: a size or a number is wrong.
  Fire(const Links& links, std::vector<Fuel> fuels, const std::vector<int>& fuel_of_cell,
       const std::vector<double>& thresholds);

  /// Begins a fire in a cell; returns false if it has no fuel, or burns or has burnt already.
  bool Ignite(const Links& links, int padded);

  /// Lets the fire burn and spread for some time [s].
  void Advance(const Links& links, double seconds);

  /// Computes again which cells ignite which others, after doors have opened or closed.
  void FollowLinks(const Links& links);

  /// Returns whether a cell beside a door burns.
  bool BurnsBeside(const Links& links, int door) const;

  const std::vector<Burning>& states() const { return states_; }
  const std::vector<Release>& releases() const { return releases_; }
  int num_burning() const { return static_cast<int>(burning_.size()); }
  double heat_release_kw() const;  ///< of all cells, now

 private:
  struct Cell {
    int padded = 0;
    double age_s = 0.0;        ///< since its ignition
    bool grows = false;        ///< a fire begins here; else it has its peak from the beginning
    double released_kj = 0.0;  ///< heat
  };

  void Begin(const Links& links, int padded, bool grows);
  void Count(const Links& links, int padded, bool burns);

  std::vector<Fuel> fuels_;
  std::vector<int> fuel_of_;        ///< with a border
  std::vector<double> thresholds_;  ///< with a border
  std::vector<double> exposures_;   ///< with a border
  /// How many burning cells reach this one, with a border: a byte for each distance, the nearest in the lowest byte.
  std::vector<std::uint64_t> burning_near_;
  std::vector<Burning> states_;  ///< with a border
  std::vector<Cell> burning_;
  std::vector<Release> releases_;
  int first_row_;  ///< with the border, of the rectangle that a fire has reached
  int last_row_ = 0;
  int first_col_;
  int last_col_ = 0;
};

}  // namespace robotteamsim::hazards
