#include "robotteamsim/sensing/odometry.hpp"

#include <algorithm>
#include <cmath>

#include "robotteamsim/base/checks.hpp"

namespace robotteamsim::sensing {
namespace {

double Square(double value) { return value * value; }

// A shorter motion [m] has no heading that is charged as a turn: wheels slip by micrometres in a turn on the spot.
constexpr double kLeastHeadedDistance = 1e-4;

/// A straight motion: its length [m], negative if backwards, and its heading in [-pi/2, pi/2].
struct StraightMotion {
  double distance;
  double heading;
};

StraightMotion StraightMotionOf(const base::Pose& motion) {
  const double distance = std::sqrt(motion.x * motion.x + motion.y * motion.y);
  // A turn on the spot has no heading: atan2(0, -0) would be pi.
  if (distance == 0.0) return {0.0, 0.0};
  if (motion.x < 0.0) return {-distance, std::atan2(-motion.y, -motion.x)};
  return {distance, std::atan2(motion.y, motion.x)};
}

// Propagates a covariance over a turn, a distance in direction (cos, sin) and a second turn: G P G^T + V M V^T, with
// the Jacobians G with respect to the previous pose and V with respect to the three errors. The error of the first turn
// adds to the yaw error of the distance; that of the second turn comes after it.
state::PoseCovariance Carried(state::PoseCovariance p, double first_variance, double distance, double distance_variance,
                              double cos, double sin, double second_variance) {
  p.yaw_yaw += first_variance;
  const double x_by_yaw = -distance * sin, y_by_yaw = distance * cos;
  p.xx += x_by_yaw * (2.0 * p.x_yaw + x_by_yaw * p.yaw_yaw) + cos * cos * distance_variance;
  p.xy += x_by_yaw * p.y_yaw + y_by_yaw * (p.x_yaw + x_by_yaw * p.yaw_yaw) + cos * sin * distance_variance;
  p.yy += y_by_yaw * (2.0 * p.y_yaw + y_by_yaw * p.yaw_yaw) + sin * sin * distance_variance;
  p.x_yaw += x_by_yaw * p.yaw_yaw;
  p.y_yaw += y_by_yaw * p.yaw_yaw;
  p.yaw_yaw += second_variance;
  return p;
}

// The same for a motion (x, y) in `odom` with equal variances in all directions and a simultaneous turn.
state::PoseCovariance CarriedOmni(state::PoseCovariance p, double x, double y, double way_variance,
                                  double turn_variance) {
  p.xx += -y * (2.0 * p.x_yaw - y * p.yaw_yaw) + way_variance;
  p.xy += -y * p.y_yaw + x * (p.x_yaw - y * p.yaw_yaw);
  p.yy += x * (2.0 * p.y_yaw + x * p.yaw_yaw) + way_variance;
  p.x_yaw -= y * p.yaw_yaw;
  p.y_yaw += x * p.yaw_yaw;
  p.yaw_yaw += turn_variance;
  return p;
}

}  // namespace

OdometryModel OdometryModel::ForSteps(double step_s) const {
  for (const double alpha : {alpha1, alpha2, alpha3, alpha4}) {
    base::CheckNotNegative(alpha, "a coefficient of the odometry");
  }
  base::CheckPositive(step_s, "step_s");
  const double scale = kOdometryStepS / step_s;
  return {scale * alpha1, scale * alpha2, scale * alpha3, scale * alpha4};
}

Odometry::Odometry(const OdometryModel& model, double step_s, bool omni)
    : model_(model.ForSteps(step_s)), step_s_(step_s), omni_(omni) {}

void Odometry::StepOmni(const base::Pose& motion, const base::Twist& twist, const Noise& noise) {
  const double turn = twist.angular_z * step_s_, distance2 = Square(motion.x) + Square(motion.y);
  const double turn_variance = model_.alpha1 * Square(turn) + model_.alpha2 * distance2;
  const double way_variance = model_.alpha3 * distance2 + model_.alpha4 * Square(turn);
  const double turn_error = noise.first_turn * std::sqrt(turn_variance);
  const double along = noise.distance * std::sqrt(way_variance), aside = noise.second_turn * std::sqrt(way_variance);
  // The heading of the motion relative to its beginning and to the middle of the step, to which the twist refers.
  const double heading = distance2 > 0.0 ? std::atan2(motion.y, motion.x) : 0.0, seen = heading - 0.5 * turn;
  const double course = pose_.yaw + heading, cos = std::cos(course), sin = std::sin(course);
  const double distance = std::sqrt(distance2) + along;
  const double x = distance * cos - aside * sin, y = distance * sin + aside * cos;
  pose_ = {pose_.x + x, pose_.y + y, base::NormaliseAngle(pose_.yaw + turn + turn_error)};
  covariance_ = CarriedOmni(covariance_, x, y, way_variance, turn_variance);
  twist_ = {twist.linear_x + (along * std::cos(seen) - aside * std::sin(seen)) / step_s_,
            twist.linear_y + (along * std::sin(seen) + aside * std::cos(seen)) / step_s_,
            twist.angular_z + turn_error / step_s_};
  const double speed_variance = way_variance / Square(step_s_);
  twist_variances_ = {speed_variance, speed_variance, turn_variance / Square(step_s_)};
}

void Odometry::Step(const base::Pose& motion, const base::Twist& twist, const Noise& noise) {
  base::Check(motion, "motion");
  base::Check({twist.linear_x, twist.linear_y, twist.angular_z}, "twist");
  base::Check({noise.first_turn, noise.distance, noise.second_turn}, "noise");
  if (omni_) return StepOmni(motion, twist, noise);
  const StraightMotion straight = StraightMotionOf(motion);
  const double turn = twist.angular_z * step_s_;
  const double rest = turn - straight.heading;
  const double first_turn = std::abs(straight.distance) < kLeastHeadedDistance ? 0.0 : straight.heading;
  const double first2 = Square(std::min(std::abs(first_turn), std::abs(turn)));
  const double second2 = Square(std::min(std::abs(turn - first_turn), std::abs(turn)));
  const double distance2 = Square(straight.distance);
  const double first_variance = model_.alpha1 * first2 + model_.alpha2 * distance2;
  const double distance_variance = model_.alpha3 * distance2 + model_.alpha4 * (first2 + second2);
  const double second_variance = model_.alpha1 * second2 + model_.alpha2 * distance2;
  const double first_error = noise.first_turn * std::sqrt(first_variance);
  const double distance_error = noise.distance * std::sqrt(distance_variance);
  const double second_error = noise.second_turn * std::sqrt(second_variance);
  const double course = pose_.yaw + straight.heading + first_error;
  const double distance = straight.distance + distance_error, cos = std::cos(course), sin = std::sin(course);
  pose_.x += distance * cos;
  pose_.y += distance * sin;
  pose_.yaw = base::NormaliseAngle(course + rest + second_error);
  covariance_ = Carried(covariance_, first_variance, distance, distance_variance, cos, sin, second_variance);
  twist_ = {twist.linear_x + distance_error / step_s_, twist.linear_y,
            twist.angular_z + (first_error + second_error) / step_s_};
  twist_variances_ = {distance_variance / Square(step_s_), 0.0, (first_variance + second_variance) / Square(step_s_)};
}

}  // namespace robotteamsim::sensing
