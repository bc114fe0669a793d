#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::world {

/// The kind of a drive.
enum class DriveKind {
  kDifferential,  ///< turns on the spot, never moves sideways
  kOmni,          ///< moves in any direction and turns at the same time
  kCar,           ///< a bicycle with base_link in the middle of its rear axle: turns only while it drives
};

/// Returns the kind with a name: differential, omni or car. Throws std::invalid_argument for another name.
DriveKind DriveKindOf(const std::string& name);

/// The limits of a drive; all those of its kind are above 0. The limits of an omnidirectional drive apply to the length
/// of its velocity in the plane and of the change of that velocity.
struct DriveLimits {
  double max_speed = 0.7;              ///< forward and backward; of kOmni in any direction [m/s]
  double max_turn = 2.0;               ///< not of kCar [rad/s]
  double max_acceleration = 2.0;       ///< [m/s^2]
  double max_turn_acceleration = 8.0;  ///< not of kCar [rad/s^2]
  DriveKind kind = DriveKind::kDifferential;
  double wheelbase = 0.0;          ///< of kCar: between the axles [m]
  double max_steering = 0.0;       ///< of kCar: to either side, below a right angle [rad]
  double max_steering_rate = 0.0;  ///< of kCar [rad/s]
};

/// The state of motion of a drive.
struct DriveSpeed {
  double forward = 0.0;   ///< [m/s]
  double turn = 0.0;      ///< counter-clockwise [rad/s]
  double left = 0.0;      ///< of kOmni [m/s]
  double steering = 0.0;  ///< of kCar: of the front wheel, counter-clockwise [rad]
};

/// Throws std::invalid_argument if the limits of its kind are not above 0, or max_steering is not below a right angle.
void CheckDrive(const DriveLimits& limits);

/// Returns the greatest speed in any direction that a drive can reach under a command [m/s].
double SpeedBound(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits);

/// Returns the speed of a drive that runs at `now`, `dt` [s] after it received `command`. It stays within the limits;
/// only an omnidirectional drive moves sideways. A car steers for the commanded turn at the speed that it then has; at
/// standstill its steering angle does not change.
DriveSpeed ReachedSpeed(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits, double dt);

/// Throws std::invalid_argument if there is not one command per robot, or a command is not finite.
void CheckCommands(const std::vector<base::Twist>& commands, std::size_t robots);

/// Returns the speeds of a team's drives, as ReachedSpeed does, for worlds whose bodies another engine moves.
/// Throws std::invalid_argument if the drives are not as many, a limit, speed or command is not usable, or dt is not
/// above 0.
std::vector<DriveSpeed> ReachedSpeeds(const std::vector<DriveSpeed>& now, const std::vector<base::Twist>& commands,
                                      const std::vector<DriveLimits>& limits, double dt);

/// Returns the yaw rate of a car at a speed [m/s] and a steering angle [rad/s].
double CarTurn(double forward, double steering, const DriveLimits& limits);

/// Returns the pose after `dt` [s] at constant speed: the end of an exact circular arc.
base::Pose AdvancedPose(const base::Pose& pose, const DriveSpeed& speed, double dt);

}  // namespace robotteamsim::world
