#pragma once

#include "robotteamsim/state/state.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::sensing {

/// The motions to which the variances of an OdometryModel refer take this long [s].
constexpr double kOdometryStepS = 0.1;

/// Variances of the odometry motion model [thrun2005, Table 5.6], for motions of kOdometryStepS.
///
/// The errors of steps are independent, and each has a variance with the square of its motion: n steps together have an
/// n-th of the variance of one step with the same motion. So the variances of shorter steps are larger in proportion,
/// and a drive has the same drift in steps of any length.
struct OdometryModel {
  double alpha1 = 0.0;  ///< of a turn per turn [rad^2/rad^2]
  double alpha2 = 0.0;  ///< of a turn per distance [rad^2/m^2]
  double alpha3 = 0.0;  ///< of a distance per distance [m^2/m^2]
  double alpha4 = 0.0;  ///< of a distance per turn [m^2/rad^2]

  /// Returns the variances for steps of a length [s].
  /// Throws std::invalid_argument if one is negative or not finite, or the step is not above 0.
  OdometryModel ForSteps(double step_s) const;
};

/// Three standard normal numbers: for the first turn, the distance and the second turn; for an omnidirectional robot:
/// for the turn, along the motion and sideways.
struct OdometryNoise {
  double first_turn = 0.0;
  double distance = 0.0;
  double second_turn = 0.0;
};

/// The motion of one step as the model describes it, with the variances of its errors: those of the first turn, the
/// distance and the second turn; for an omnidirectional robot those of the turn, along the motion and sideways.
struct ModelledMotion {
  /// Where a robot is after the motion, its displacement (x, y) and the direction of the motion, in the same frame.
  struct Moved {
    base::Pose pose;
    double x = 0.0;
    double y = 0.0;
    double cos = 1.0;
    double sin = 0.0;
  };

  /// Args: motion: in the frame of its beginning, its yaw is not used; turn: of the body [rad], of any size.
  ModelledMotion(const OdometryModel& model, const base::Pose& motion, double turn, bool omni);

  /// Returns the errors that random numbers stand for [rad, m, rad], or [rad, m, m].
  OdometryNoise ErrorsOf(const OdometryNoise& noise) const;

  /// Returns where a robot that starts at `from` is after the motion with these errors.
  Moved From(const base::Pose& from, const OdometryNoise& errors) const;

  bool omni;
  double turn;
  double heading = 0.0;   ///< relative to the yaw at its beginning [rad]
  double distance = 0.0;  ///< negative if backwards [m]
  OdometryNoise variances;
  OdometryNoise deviations;
};

/// A robot's odometry: its true motion plus drift, in a frame `odom` that begins where the robot does.
///
/// A motion is a turn, a distance and a second turn, each with Gaussian noise of the variances
///
///     turns:    alpha1 turn^2 + alpha2 distance^2
///     distance: alpha3 distance^2 + alpha4 (first turn^2 + second turn^2)
///
/// so a robot that does not move, blocked or not, does not drift. Two cases that the model leaves open: the distance of
/// a robot that drives backwards is negative, since it did not turn round; and a robot that is pushed aside or slides
/// has turned only as much as its body did, whatever the direction of its motion.
///
/// An omnidirectional robot turns while it moves, with the same errors sideways as forwards. Its motion consists of a
/// distance, a sideways distance, 0 except for noise, and a turn, as in amcl's omnidirectional model [amcl]:
///
///     turn:                alpha1 turn^2 + alpha2 distance^2
///     distance, and aside: alpha3 distance^2 + alpha4 turn^2
///
/// The covariance is that of these errors, propagated with the Jacobians of the model at the estimated pose: a
/// first-order approximation, valid while the yaw error is small (up to about 0.3 rad).
class Odometry {
 public:
  /// Args: step_s: length of a step [s]; omni: whether the robot is omnidirectional.
  /// Throws std::invalid_argument if a coefficient is negative or not finite, or the step is not above 0.
  Odometry(const OdometryModel& model, double step_s, bool omni = false);

  /// Adds one step. Args: motion: in the frame of its beginning; twist: the mean velocity, in base_link.
  void Step(const base::Pose& motion, const base::Twist& twist, const OdometryNoise& noise);

  /// The estimated pose in `odom`.
  const base::Pose& pose() const { return pose_; }
  /// The twist that the wheels measured in the last step, in base_link.
  const base::Twist& twist() const { return twist_; }

  /// The covariance of the estimated pose.
  const state::PoseCovariance& covariance() const { return covariance_; }
  /// The variances of the measured twist.
  const state::TwistVariances& twist_variances() const { return twist_variances_; }

 private:
  OdometryModel model_;
  double step_s_;
  bool omni_;
  base::Pose pose_;
  base::Twist twist_;
  state::PoseCovariance covariance_;
  state::TwistVariances twist_variances_;
};

}  // namespace robotteamsim::sensing
