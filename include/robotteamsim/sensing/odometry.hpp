#pragma once

#include <vector>

#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::sensing {

/// Variances of the odometry motion model [thrun2005, Table 5.6].
struct OdometryModel {
  double alpha1 = 0.0;  ///< of a turn per turn [rad^2/rad^2]
  double alpha2 = 0.0;  ///< of a turn per distance [rad^2/m^2]
  double alpha3 = 0.0;  ///< of a distance per distance [m^2/m^2]
  double alpha4 = 0.0;  ///< of a distance per turn [m^2/rad^2]
};

/// The covariance of the error of a pose (x, y, yaw): its upper triangle, row by row.
struct PoseCovariance {
  double xx = 0.0;       ///< [m^2]
  double xy = 0.0;       ///< [m^2]
  double x_yaw = 0.0;    ///< [m rad]
  double yy = 0.0;       ///< [m^2]
  double y_yaw = 0.0;    ///< [m rad]
  double yaw_yaw = 0.0;  ///< [rad^2]
};

/// A robot's odometry: its true motion plus drift, in a frame `odom` that begins where the robot does.
///
/// A motion is a turn, a distance and a second turn, each with Gaussian noise of the variances
///
///     turns:    alpha1 turn^2 + alpha2 distance^2
///     distance: alpha3 distance^2 + alpha4 (first turn^2 + second turn^2)
///
/// so a robot that stands still, blocked or not, does not drift. Two cases that the model leaves open: a distance is
/// negative when the robot drives backwards, as turning round was no part of that; and a robot that is pushed aside or
/// slides has turned no more than its body did, whatever the direction it went.
///
/// An omnidirectional robot turns while it goes, and errs to the side of its way as along it. Its motion is a distance,
/// a way to the side, which is none but for noise, and a turn, as amcl's omnidirectional model has them [amcl]:
///
///     turn:                alpha1 turn^2 + alpha2 distance^2
///     distance, and aside: alpha3 distance^2 + alpha4 turn^2
///
/// The covariance is that of these errors, carried on by the Jacobians of the model at the believed pose: to first
/// order, so it holds while the error of yaw is small (sin about linear; 0.3 rad or so).
class Odometry {
 public:
  /// Three numbers of the standard normal distribution: of the first turn, the distance and the second turn; of an
  /// omnidirectional robot: of the turn, along the way and to its side.
  struct Noise {
    double first_turn = 0.0;
    double distance = 0.0;
    double second_turn = 0.0;
  };

  /// Args: step: length of a step [s]; omni: whether the robot is omnidirectional.
  Odometry(const OdometryModel& model, double step, bool omni = false) : model_(model), step_(step), omni_(omni) {}

  /// Adds one step. Args: motion: its way, seen from its beginning; twist: its mean velocity, in base_link.
  void Step(const base::Pose& motion, const base::Twist& twist, const Noise& noise);

  /// Where the robot believes to be, in `odom`.
  const base::Pose& pose() const { return pose_; }
  /// What its wheels measured in the last step, in base_link.
  const base::Twist& twist() const { return twist_; }

  /// How far that pose may be from the true one.
  const PoseCovariance& covariance() const { return covariance_; }
  /// Variance of the forward speed of that twist [m^2/s^2].
  double speed_variance() const { return speed_variance_; }
  /// Variance of its speed to the left [m^2/s^2], independent of the others; 0 unless the robot is omnidirectional.
  double sideways_variance() const { return omni_ ? speed_variance_ : 0.0; }
  /// Variance of its turn [rad^2/s^2], independent of the speed's.
  double turn_variance() const { return turn_variance_; }

 private:
  void StepOmni(const base::Pose& motion, const base::Twist& twist, const Noise& noise);

  OdometryModel model_;
  double step_;
  bool omni_;
  base::Pose pose_;
  base::Twist twist_;
  PoseCovariance covariance_;
  double speed_variance_ = 0.0;
  double turn_variance_ = 0.0;
};

}  // namespace robotteamsim::sensing
