#pragma once

#include <cmath>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::base {

/// The largest number that the library accepts, in any unit: squares and products of such numbers stay finite.
constexpr double kLargest = 1e9;
/// The smallest number above 0 that it accepts as a size, a duration or a limit: quotients stay finite.
constexpr double kSmallest = 1e-9;

/// Return whether a number is finite and its magnitude at most kLargest; false for NaN.
inline bool IsUsable(double value) { return std::abs(value) <= kLargest; }
inline bool IsUsable(const Point& point) { return IsUsable(point.x) && IsUsable(point.y); }
inline bool IsUsable(const Pose& pose) { return IsUsable(pose.x) && IsUsable(pose.y) && IsUsable(pose.yaw); }

/// Returns whether a number is a size, a duration or a limit: from kSmallest to kLargest.
inline bool IsPositive(double value) { return value >= kSmallest && value <= kLargest; }

/// Throw std::invalid_argument, which names the argument, unless it is usable.
void Check(double value, const char* name);
void Check(const Point& point, const char* name);
void Check(const Pose& pose, const char* name);

/// Throw std::invalid_argument, which names the argument, unless it is usable and >= 0, or positive.
void CheckNotNegative(double value, const char* name);
void CheckPositive(double value, const char* name);

/// Throw std::invalid_argument, which names the argument, unless it is usable or infinite, as a range without a return
/// may be. In single precision a larger number would become infinite, too.
void CheckUsableOrInfinite(double value, const char* name);

/// Returns a number as an int: truncated, and limited to the range from low to high; low for NaN.
inline int ClampedInt(double value, int low, int high) {
  if (!(value > low)) return low;
  return value < high ? static_cast<int>(value) : high;
}

}  // namespace robotteamsim::base
