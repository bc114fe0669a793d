#pragma once

#include <vector>

namespace robotteamsim::world {

/// Returns a number in [0, 4] that grows with the angle of (x, y), counter-clockwise from the x axis, like atan2, at
/// the cost of one division.
double PseudoAngle(double x, double y);

/// The beams of a fan in order of direction, in a frame whose x axis is the beam with the smallest angle.
class SortedBeams {
 public:
  /// The beams are evenly spaced from angle_min_rad to angle_max_rad, in either direction [rad].
  SortedBeams(int beams, double angle_min_rad, double angle_max_rad);

  int Count() const { return static_cast<int>(x_.size()); }

  /// Angle of the frame's x axis in base_link [rad].
  double Zero() const { return zero_; }

  /// Returns whether no beam points below the x axis.
  bool IsHalf() const { return is_half_; }

  /// Unit vectors of the beams.
  const double* X() const { return x_.data(); }
  const double* Y() const { return y_.data(); }

  /// Returns the place in this order of a beam of the fan.
  int PlaceOf(int beam) const { return place_[beam]; }

  /// Returns whether this order is that of the fan.
  bool IsInOrder() const { return is_in_order_; }

  /// Calls meet(first, end) for the beams within [right, left], pseudo-angles that span less than half a turn, ends
  /// included.
  template <typename Meet>
  void ForBeamsBetween(double right, double left, const Meet& meet) const {
    const int first = FirstFrom(right - kSlack);
    const int end = FirstFrom(left + kSlack);
    if (right <= left) {
      meet(first, end);
    } else {
      meet(first, Count());
      meet(0, end);
    }
  }

 private:
  // No beam may slip through the corner of two walls because of rounding.
  static constexpr double kSlack = 1e-12;

  int FirstFrom(double pseudo_angle) const;

  double zero_;
  bool is_half_;
  bool is_in_order_ = true;
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> pseudo_angle_;  // ascending
  std::vector<int> place_;
  double bins_per_unit_;
  std::vector<int> first_in_bin_;  // of pseudo-angles: the first beam in the bin or beyond it
};

}  // namespace robotteamsim::world
