#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

namespace robotteamsim::hazards {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Cells along an axis of the longest step in a common direction: the shortest paths are at most 1.3 % longer than the
/// straight line.
inline constexpr int kLongestStep = 3;

/// A step between two cells along which fire spreads over fuel, in whole cells.
struct Direction {
  int dx = 0;
  int dy = 0;
};

/// Returns the 32 directions of at most kLongestStep cells per axis, counter-clockwise from -pi.
std::vector<Direction> CommonDirections();

/// Returns the area that a front of speed 1 encloses after a time of 1: that of the polygon with a corner at the
/// distance 1 in each common direction.
double FrontArea();

/// When a front that nothing hinders reaches the edges of its cells, in order [times to cross a cell].
class FreeArrivals {
 public:
  /// Returns the arrival at the cell of an index; the fire begins in cell 0, at 0.
  double At(int index);

 private:
  void Extend();

  int reach_ = 8;
  std::vector<double> at_;
};

/// A heat release rate, linear between given times; it keeps its last value.
class HeatCurve {
 public:
  HeatCurve() = default;
  /// Args: points: time since the beginning [s] and rate [kW].
  /// Throws std::invalid_argument: times do not ascend, or a number is not finite or below 0.
  explicit HeatCurve(std::vector<std::pair<double, double>> points);

  bool empty() const { return points_.empty(); }
  double RateAt(double seconds) const;     ///< [kW]
  double HeatUntil(double seconds) const;  ///< [kJ]
  double TimeOf(double rate_kw) const;     ///< when the rate is first as high [s]; infinite: never
  double EndTime() const;                  ///< from when on the rate is 0 for good [s]; infinite: never

 private:
  std::vector<std::pair<double, double>> points_;
};

/// The front of one fire over connected fuel: which cell it reaches next. Its own clock, in which walls delay nothing
/// but detours, only gives the order.
class Front {
 public:
  struct Next {
    double at = 0.0;  ///< of the front's own clock
    int padded = 0;
    bool operator>(const Next& other) const { return at != other.at ? at > other.at : padded > other.padded; }
  };

  /// Args: fuel: where the fire began.
  Front(int fuel, double begin_s) : fuel(fuel), begin_s(begin_s), last_s(begin_s) {}

  /// Notes that the front reaches a cell, unless it does so earlier from elsewhere.
  void Offer(int padded, double at);

  /// Returns the next cell, which is_free decides on; null: there is none.
  template <typename IsFree>
  const Next* Peek(const IsFree& is_free) {
    while (!queue_.empty()) {
      const Next& next = queue_.top();
      if (is_free(next.padded) && due_.at(next.padded) == next.at) return &next;
      queue_.pop();
    }
    return nullptr;
  }

  int fuel;
  double begin_s;
  double last_s;             ///< when the last cell began to burn
  double last_at = 0.0;      ///< the same by the front's own clock
  int num_cells = 0;         ///< that have begun to burn
  double released_kj = 0.0;  ///< by the curve of the fuel

 private:
  std::unordered_map<int, double> due_;
  std::priority_queue<Next, std::vector<Next>, std::greater<>> queue_;
};

}  // namespace robotteamsim::hazards
