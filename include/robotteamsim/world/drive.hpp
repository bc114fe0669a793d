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
  double max_speed_mps = 0.7;   ///< forward and backward; of kOmni in any direction
  double max_turn_radps = 2.0;  ///< not of kCar
  double max_acceleration_mps2 = 2.0;
  double max_turn_acceleration_radps2 = 8.0;  ///< not of kCar
  DriveKind kind = DriveKind::kDifferential;
  double wheelbase_m = 0.0;              ///< of kCar: between the axles
  double max_steering_rad = 0.0;         ///< of kCar: to either side, below a right angle
  double max_steering_rate_radps = 0.0;  ///< of kCar
};

/// The state of motion of a drive.
struct DriveSpeed {
  double forward_mps = 0.0;
  double turn_radps = 0.0;    ///< counter-clockwise
  double left_mps = 0.0;      ///< of kOmni
  double steering_rad = 0.0;  ///< of kCar: of the front wheel, counter-clockwise
};

/// Throws std::invalid_argument if the limits of its kind are not above 0, or max_steering is not below a right angle.
void CheckDrive(const DriveLimits& limits);

/// Returns the greatest speed in any direction that a drive can reach under a command [m/s].
double SpeedBound(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits);

/// Returns the speed of a drive that runs at `now`, `dt_s` after it received `command`. It stays within the limits;
/// only an omnidirectional drive moves sideways. A car steers for the commanded turn at the speed that it then has; at
/// standstill its steering angle does not change.
DriveSpeed ReachedSpeed(const DriveSpeed& now, const base::Twist& command, const DriveLimits& limits, double dt_s);

/// Throws std::invalid_argument if there is not one command per robot, or a command is not finite.
void CheckCommands(const std::vector<base::Twist>& commands, std::size_t robots);

/// Returns the speeds of a team's drives, as ReachedSpeed does, for worlds whose bodies another engine moves.
/// Throws std::invalid_argument if the drives are not as many, a limit, speed or command is not usable, or dt is not
/// above 0.
std::vector<DriveSpeed> ReachedSpeeds(const std::vector<DriveSpeed>& now, const std::vector<base::Twist>& commands,
                                      const std::vector<DriveLimits>& limits, double dt_s);

/// Returns the yaw rate of a car at a speed [m/s] and a steering angle [rad].
double CarTurn(double forward_mps, double steering_rad, const DriveLimits& limits);

/// Returns the pose after `dt_s` at constant speed: the end of an exact circular arc.
base::Pose AdvancedPose(const base::Pose& pose, const DriveSpeed& speed, double dt_s);

}  // namespace robotteamsim::world
