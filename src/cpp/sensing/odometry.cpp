#include "robotteamsim/sensing/odometry.hpp"

#include <algorithm>
#include <cmath>

namespace robotteamsim {
namespace {

double Square(double value) { return value * value; }

/// A straight way: its length [m], below 0 when it went backwards, and its heading in [-pi/2, pi/2].
struct Way {
  double distance;
  double heading;
};

Way WayOf(const Pose& motion) {
  const double distance = std::sqrt(motion.x * motion.x + motion.y * motion.y);
  if (motion.x < 0.0) return {-distance, std::atan2(-motion.y, -motion.x)};
  return {distance, std::atan2(motion.y, motion.x)};
}

}  // namespace

void Odometry::Step(const Pose& motion, const Twist& twist, const Noise& noise) {
  const Way way = WayOf(motion);
  const double turn = twist.angular_z * step_;
  const double rest = turn - way.heading;
  const double first2 = Square(std::min(std::abs(way.heading), std::abs(turn)));
  const double second2 = Square(std::min(std::abs(rest), std::abs(turn)));
  const double distance2 = Square(way.distance);
  const double first_error = noise.first_turn * std::sqrt(model_.alpha1 * first2 + model_.alpha2 * distance2);
  const double distance_error =
      noise.distance * std::sqrt(model_.alpha3 * distance2 + model_.alpha4 * (first2 + second2));
  const double second_error = noise.second_turn * std::sqrt(model_.alpha1 * second2 + model_.alpha2 * distance2);
  const double course = pose_.yaw + way.heading + first_error;
  pose_.x += (way.distance + distance_error) * std::cos(course);
  pose_.y += (way.distance + distance_error) * std::sin(course);
  pose_.yaw = NormaliseAngle(course + rest + second_error);
  twist_ = {twist.linear_x + distance_error / step_, twist.linear_y,
            twist.angular_z + (first_error + second_error) / step_};
}

}  // namespace robotteamsim
