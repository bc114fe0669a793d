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

// Propagates a covariance over a turn, a distance and a second turn: G P G^T + V M V^T, with the Jacobians G with
// respect to the previous pose and V with respect to the three errors. The error of the first turn adds to the yaw
// error of the distance; that of the second turn comes after it.
state::PoseCovariance Carried(state::PoseCovariance p, const ModelledMotion::Moved& moved,
                              const OdometryNoise& variances) {
  p.yaw_yaw += variances.first_turn;
  const double x_by_yaw = -moved.y, y_by_yaw = moved.x;
  p.xx += x_by_yaw * (2.0 * p.x_yaw + x_by_yaw * p.yaw_yaw) + moved.cos * moved.cos * variances.distance;
  p.xy += x_by_yaw * p.y_yaw + y_by_yaw * (p.x_yaw + x_by_yaw * p.yaw_yaw) + moved.cos * moved.sin * variances.distance;
  p.yy += y_by_yaw * (2.0 * p.y_yaw + y_by_yaw * p.yaw_yaw) + moved.sin * moved.sin * variances.distance;
  p.x_yaw += x_by_yaw * p.yaw_yaw;
  p.y_yaw += y_by_yaw * p.yaw_yaw;
  p.yaw_yaw += variances.second_turn;
  return p;
}

// The same for a motion with equal variances in all directions and a simultaneous turn.
state::PoseCovariance CarriedOmni(state::PoseCovariance p, const ModelledMotion::Moved& moved,
                                  const OdometryNoise& variances) {
  p.xx += -moved.y * (2.0 * p.x_yaw - moved.y * p.yaw_yaw) + variances.distance;
  p.xy += -moved.y * p.y_yaw + moved.x * (p.x_yaw - moved.y * p.yaw_yaw);
  p.yy += moved.x * (2.0 * p.y_yaw + moved.x * p.yaw_yaw) + variances.distance;
  p.x_yaw -= moved.y * p.yaw_yaw;
  p.y_yaw += moved.x * p.yaw_yaw;
  p.yaw_yaw += variances.first_turn;
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

ModelledMotion::ModelledMotion(const OdometryModel& model, const base::Pose& motion, double whole_turn, bool is_omni)
    : omni(is_omni), turn(whole_turn) {
  if (omni) {
    const double distance2 = Square(motion.x) + Square(motion.y);
    heading = distance2 > 0.0 ? std::atan2(motion.y, motion.x) : 0.0;
    distance = std::sqrt(distance2);
    const double way_variance = model.alpha3 * distance2 + model.alpha4 * Square(turn);
    variances = {model.alpha1 * Square(turn) + model.alpha2 * distance2, way_variance, way_variance};
  } else {
    const StraightMotion straight = StraightMotionOf(motion);
    heading = straight.heading;
    distance = straight.distance;
    const double first_turn = std::abs(distance) < kLeastHeadedDistance ? 0.0 : heading;
    const double first2 = Square(std::min(std::abs(first_turn), std::abs(turn)));
    const double second2 = Square(std::min(std::abs(turn - first_turn), std::abs(turn)));
    const double distance2 = Square(distance);
    variances = {model.alpha1 * first2 + model.alpha2 * distance2,
                 model.alpha3 * distance2 + model.alpha4 * (first2 + second2),
                 model.alpha1 * second2 + model.alpha2 * distance2};
  }
  deviations = {std::sqrt(variances.first_turn), std::sqrt(variances.distance), std::sqrt(variances.second_turn)};
}

OdometryNoise ModelledMotion::ErrorsOf(const OdometryNoise& noise) const {
  return {noise.first_turn * deviations.first_turn, noise.distance * deviations.distance,
          noise.second_turn * deviations.second_turn};
}

ModelledMotion::Moved ModelledMotion::From(const base::Pose& from, const OdometryNoise& errors) const {
  const double course = from.yaw + heading + (omni ? 0.0 : errors.first_turn);
  const double along = distance + errors.distance, aside = omni ? errors.second_turn : 0.0;
  const double cos = std::cos(course), sin = std::sin(course);
  const double x = omni ? along * cos - aside * sin : along * cos;
  const double y = omni ? along * sin + aside * cos : along * sin;
  const double yaw = omni ? from.yaw + turn + errors.first_turn : course + (turn - heading) + errors.second_turn;
  return {{from.x + x, from.y + y, base::NormaliseAngle(yaw)}, x, y, cos, sin};
}

void Odometry::Step(const base::Pose& motion, const base::Twist& twist, const OdometryNoise& noise) {
  base::Check(motion, "motion");
  base::Check({twist.linear_x, twist.linear_y, twist.angular_z}, "twist");
  base::Check({noise.first_turn, noise.distance, noise.second_turn}, "noise");
  const ModelledMotion modelled(model_, motion, twist.angular_z * step_s_, omni_);
  const OdometryNoise errors = modelled.ErrorsOf(noise), &variances = modelled.variances;
  const ModelledMotion::Moved moved = modelled.From(pose_, errors);
  pose_ = moved.pose;
  const double speed_variance = variances.distance / Square(step_s_);
  if (omni_) {
    covariance_ = CarriedOmni(covariance_, moved, variances);
    // The heading of the motion relative to the middle of the step, to which the twist refers.
    const double seen = modelled.heading - 0.5 * modelled.turn, cos = std::cos(seen), sin = std::sin(seen);
    twist_ = {twist.linear_x + (errors.distance * cos - errors.second_turn * sin) / step_s_,
              twist.linear_y + (errors.distance * sin + errors.second_turn * cos) / step_s_,
              twist.angular_z + errors.first_turn / step_s_};
    twist_variances_ = {speed_variance, speed_variance, variances.first_turn / Square(step_s_)};
  } else {
    covariance_ = Carried(covariance_, moved, variances);
    twist_ = {twist.linear_x + errors.distance / step_s_, twist.linear_y,
              twist.angular_z + (errors.first_turn + errors.second_turn) / step_s_};
    twist_variances_ = {speed_variance, 0.0, (variances.first_turn + variances.second_turn) / Square(step_s_)};
  }
}

}  // namespace robotteamsim::sensing
