#include "robotteamsim/base/geometry.hpp"

#include <cmath>

namespace robotteamsim::base {
namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

double NormaliseAngle(double angle_rad) {
  if (-kPi < angle_rad && angle_rad <= kPi) return angle_rad;  // as almost always
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped == -kPi ? kPi : wrapped;
}

Pose RelativePose(const Pose& from, const Pose& to) {
  const double cos = std::cos(from.yaw), sin = std::sin(from.yaw);
  const double dx = to.x - from.x, dy = to.y - from.y;
  return {cos * dx + sin * dy, cos * dy - sin * dx, NormaliseAngle(to.yaw - from.yaw)};
}

Pose Composed(const Pose& from, const Pose& motion) {
  const double cos = std::cos(from.yaw), sin = std::sin(from.yaw);
  return {from.x + cos * motion.x - sin * motion.y, from.y + sin * motion.x + cos * motion.y,
          NormaliseAngle(from.yaw + motion.yaw)};
}

}  // namespace robotteamsim::base
