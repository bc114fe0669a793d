#pragma once

#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "robotteamsim/hazards/front.hpp"
#include "robotteamsim/hazards/links.hpp"

namespace robotteamsim::hazards {

/// What burns in one cell.
struct Fuel {
  double load_kj = 0.0;       ///< heat of all of it
  double peak_kw = 0.0;       ///< highest heat release rate
  double growth_kw_s2 = 0.0;  ///< of the t-squared fire
  /// Heat release rate of all of it, over the time since it began to burn [s, kW]; then its load does not matter, and
  /// its growth only for how fast fire crosses to other fuel. Empty: a t-squared fire.
  std::vector<std::pair<double, double>> curve;
};

enum class Burning : std::uint8_t { kNot, kBurns, kBurntOut };

/// A cell that burns, and the heat that it released in the last step [kJ].
struct Release {
  int padded = 0;
  double heat_kj = 0.0;
};

/// Fire whose front moves from cell to cell.
///
/// The front of a t-squared fire on uniform fuel is a circle: growth * t^2 = peak per area * pi * (speed * t)^2. So the
/// front crosses a cell in T * sqrt(pi) with T = sqrt(peak / growth), both of the cell, whatever its size. It runs
/// along straight steps between the centres of cells (Dijkstra's algorithm): after a time t it is then a polygon with a
/// corner in the direction of each kind of step. The area of this polygon replaces pi, so that the heat release rate on
/// uniform fuel is growth * t^2 on a grid of any size.
///
/// Walls and the end of fuel cut the circle, but not the heat release: the n-th cell that a fire reaches begins to burn
/// when the n-th cell of a front that nothing hinders would. So the rest of the front is faster. Through doors, over
/// gaps and to a fuel with a curve of its own, the front moves at its own speed, and a new fire begins there, unless
/// something burns in the same region, whose fire the cell then joins.
///
/// A cell burns from when the front reaches its edge, and its heat release rate rises to the peak in the time that the
/// front needs to cross it; where a fire begins, it is growth * t^2 up to the peak. Each burns until its load is spent.
/// A fuel with a curve burns in as many cells as the highest rate so far needs, which share the rate equally.
class Fire {
 public:
  /// Args: fuels: kinds of fuel.  fuel_of_cell: per cell, the kind; -1 for none.  gap: the width of ground without fuel
  /// that the front can cross [cells].
  /// Throws std::invalid_argument: a size or a number is wrong.
  Fire(const Links& links, std::vector<Fuel> fuels, const std::vector<int>& fuel_of_cell, double gap);

  /// Sets fire to a cell; returns whether a fire begins there. None does where there is no fuel, where it burns or has
  /// burnt already, and in a fuel with a curve that has been lit before.
  bool Ignite(int padded);

  /// Lets the fire burn and spread for some time [s].
  void Advance(const Links& links, double seconds);

  /// Computes again which cells the front will reach, after doors have opened or closed. From where it already was
  /// beside an opened door, it begins to move through the door now.
  void FollowLinks(const Links& before, const Links& after);

  /// Returns whether a cell beside a door burns.
  bool BurnsBeside(const Links& links, int door) const;

  const std::vector<Burning>& states() const { return states_; }
  const std::vector<Release>& releases() const { return releases_; }
  int num_burning() const { return static_cast<int>(burning_.size()); }
  double heat_release_kw() const;  ///< of all cells, now

 private:
  struct Cell {
    int padded = 0;
    double since_s = 0.0;
    bool begins = false;       ///< a fire begins here
    double released_kj = 0.0;  ///< heat
    int front = 0;             ///< the fire to which the cell belongs
  };

  /// A step between the centres of two cells.
  struct Step {
    int dx = 0;
    int dy = 0;
    double length = 0.0;        ///< [cells]
    std::vector<int> single;    ///< steps to neighbours that lead there: 0 east, 1 north, 2 west, 3 south
    bool crosses_gaps = false;  ///< over ground without fuel
    bool is_common = false;     ///< over fuel
  };

  /// Fire reaches a cell from another region, or the centre of a cell, from where it moves on to other regions.
  struct Event {
    double at_s = 0.0;
    int padded = 0;
    bool at_centre = false;
    bool operator>(const Event& other) const { return at_s != other.at_s ? at_s > other.at_s : padded > other.padded; }
  };

  static std::vector<Step> StepsFor(double gap);
  const Fuel& FuelOf(const Cell& cell) const { return fuels_[fuel_of_[cell.padded]]; }
  const HeatCurve& CurveOf(const Front& front) const { return curves_[front.fuel]; }
  double CrossingTime(int padded) const { return crossing_s_[fuel_of_[padded]]; }
  double CentreTime(const Cell& cell) const;
  double HeatOf(const Cell& cell) const;
  double RateOf(const Cell& cell) const;
  double PassageTime(int from, int to, const Step& step) const;
  std::pair<double, int> NextFront();  ///< when the next cell of a front begins to burn, and of which
  const Front::Next* Peek(int front);
  void Handle(const Links& links);  ///< the next event
  void GiveOff();
  void Begin(int padded, double at_s);
  void Arrive(int padded, double at_s);
  void Take(int index, int padded, double at, bool begins);
  int Target(const Links& links, int from, const Step& step) const;
  void MoveOn(const Links& links, int from, double at_s, const Step& step);
  bool CanMove(const Links& links, int from, const Step& step) const;
  bool IsInner(int from, const Step& step) const;  ///< whether the step stays in one region
  template <typename Allowed>
  bool IsFree(const Links& links, int from, const Step& step, const Allowed& allowed) const;
  template <typename Allowed>
  bool IsFreeOneWay(const Links& links, int from, const Step& step, const Allowed& allowed, bool backwards) const;

  std::vector<Fuel> fuels_;
  std::vector<HeatCurve> curves_;  ///< of each fuel
  Links still_;                    ///< with all doors closed
  FreeArrivals free_;
  std::vector<Front> fronts_;
  std::vector<int> region_of_;        ///< with a border
  std::vector<int> front_of_region_;  ///< the first fire there; -1: none
  std::vector<double> crossing_s_;    ///< of each fuel: time in which the front crosses a cell
  std::vector<Step> steps_;
  int rows_;
  int cols_;
  double time_s_ = 0.0;
  std::vector<int> fuel_of_;     ///< with a border
  std::vector<double> due_s_;    ///< with a border: when fire from another region arrives
  std::vector<int> from_;        ///< with a border: the cell from which it does
  std::vector<Burning> states_;  ///< with a border
  std::vector<Cell> burning_;
  std::vector<Release> releases_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
};

}  // namespace robotteamsim::hazards
