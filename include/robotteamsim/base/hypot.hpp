#pragma once

#include <algorithm>
#include <cmath>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::base {

namespace hypot_detail {

/// head + tail is exactly a * a [dekker1971]; without overflow for |a| < 2^500.
struct Square {
  explicit Square(double a) : head(a * a) {
    const double big = 134217729.0 * a;  // 2^27 + 1: the upper half of the digits of a
    const double upper = big - (big - a), lower = a - upper;
    tail = lower * lower - ((head - upper * upper) - 2.0 * upper * lower);
  }
  double head, tail;
};

/// sqrt(large^2 + small^2) for large >= small >= 0, neither near the ends of the range of double.
inline double Hypot(double large, double small) {
  const double root = std::sqrt(large * large + small * small);
  // The error of the squared root: the heads cancel except for their last digits.
  const Square x(large), y(small), r(root);
  const double missing = ((x.head - r.head) + y.head) + ((x.tail - r.tail) + y.tail);
  return root + missing / (2.0 * root);
}

}  // namespace hypot_detail

/// Returns sqrt(x^2 + y^2) rounded to the nearest double, ties to even. Python's `math.hypot` and `math.dist` return
/// the same except for ties and for lengths below 1e-300; the hypot of a C library differs in one case of 100.
inline double Hypot(double x, double y) {
  const double large = std::max(std::abs(x), std::abs(y)), small = std::min(std::abs(x), std::abs(y));
  if (large > 1e-140 && large < 1e140 && !std::isnan(x + y)) return hypot_detail::Hypot(large, small);
  if (std::isinf(x) || std::isinf(y)) return HUGE_VAL;
  if (std::isnan(x + y)) return x + y;
  if (large == 0.0) return 0.0;
  const int exponent = std::ilogb(large);
  return std::ldexp(hypot_detail::Hypot(std::ldexp(large, -exponent), std::ldexp(small, -exponent)), exponent);
}

/// Returns the distance between two points [m].
inline double Distance(const Point& a, const Point& b) { return Hypot(a.x - b.x, a.y - b.y); }

}  // namespace robotteamsim::base
