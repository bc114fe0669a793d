#include "robotteamsim/base/checks.hpp"

#include <sstream>
#include <stdexcept>

namespace robotteamsim::base {
namespace {

template <typename... Numbers>
[[noreturn]] void Reject(const char* name, const char* expected, const Numbers&... numbers) {
  std::ostringstream message;
  const char* separator = sizeof...(numbers) > 1 ? "(" : "";
  message << name << " must be " << expected << ", got ";
  ((message << separator << numbers, separator = ", "), ...);
  message << (sizeof...(numbers) > 1 ? ")" : "");
  throw std::invalid_argument(message.str());
}

template <typename... Numbers>
[[noreturn]] void RejectUnusable(const char* name, const Numbers&... numbers) {
  const bool is_finite = (std::isfinite(numbers) && ...);
  Reject(name, is_finite ? "within 1e9" : "finite", numbers...);
}

}  // namespace

void Check(double value, const char* name) {
  if (!IsUsable(value)) RejectUnusable(name, value);
}

void Check(const Point& point, const char* name) {
  if (!IsUsable(point)) RejectUnusable(name, point.x, point.y);
}

void Check(const Pose& pose, const char* name) {
  if (!IsUsable(pose)) RejectUnusable(name, pose.x, pose.y, pose.yaw);
}

void CheckNotNegative(double value, const char* name) {
  if (!(value >= 0.0 && value <= kLargest)) Reject(name, "from 0 to 1e9", value);
}

void CheckPositive(double value, const char* name) {
  if (!IsPositive(value)) Reject(name, "> 0, from 1e-9 to 1e9", value);
}

void CheckUsableOrInfinite(double value, const char* name) {
  if (!IsUsable(value) && !std::isinf(value)) Reject(name, "within 1e9 or infinite", value);
}

}  // namespace robotteamsim::base
