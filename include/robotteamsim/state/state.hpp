#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/state/pose_reading.hpp"
#include "robotteamsim/world/drive.hpp"

namespace robotteamsim::state {

/// The covariance of the error of a pose (x, y, yaw): its upper triangle, row by row.
struct PoseCovariance {
  double xx = 0.0;       ///< [m^2]
  double xy = 0.0;       ///< [m^2]
  double x_yaw = 0.0;    ///< [m rad]
  double yy = 0.0;       ///< [m^2]
  double y_yaw = 0.0;    ///< [m rad]
  double yaw_yaw = 0.0;  ///< [rad^2]
};

/// The variances of the errors of a twist, which are independent of each other.
struct TwistVariances {
  double forward = 0.0;  ///< [m^2/s^2]
  double left = 0.0;     ///< [m^2/s^2]; 0 unless the robot is omnidirectional
  double turn = 0.0;     ///< [rad^2/s^2]
};

/// What has happened in a step of a mission, as bits of `State::happened`.
enum Happening : std::uint8_t {
  kPlaceReached = 1,  ///< a robot is at one of the places that its mission watches
  kLinksChanged = 2,  ///< a link has come, gone, or become weak or strong, or somebody has come or gone
  kVoiceChanged = 4,  ///< the loudest cell near a robot is another one than when it last heard a voice
  kContact = 8,       ///< a robot touches something
  kDoorMoved = 16,    ///< the state of a door has changed
};

/// The numbers of N missions after a step: what moved, what was measured, who hears whom. Each array has a row per
/// robot of the first mission, then per robot of the second one, and so on; matrices have a row and a column per robot
/// of a mission. Worlds, sensors, voices and links each write their part; whoever reads does not know who wrote.
///
/// A robot whose true position is NaN is absent: its other entries mean nothing.
struct State {
  /// Args: robots: of each mission; beams: of the laser that has most.
  /// Throws std::invalid_argument if there is no mission, or the arrays would have more than 1e8 numbers.
  State(std::size_t missions, std::size_t robots, std::size_t beams);

  std::size_t missions, robots, beams;

  std::vector<PoseReading> true_pose;               ///< in `map`
  std::vector<base::Twist> true_twist;              ///< the mean velocity in the step, in base_link
  std::vector<std::uint8_t> contact;                ///< whether it touches something: 0 or 1
  std::vector<std::vector<double>> contact_angles;  ///< directions of contacts in base_link, ascending in (-pi, pi]

  std::vector<PoseReading> odometry_pose;   ///< in `odom`
  std::vector<base::Twist> odometry_twist;  ///< that the wheels measured, in base_link
  std::vector<PoseCovariance> odometry_pose_covariance;
  std::vector<TwistVariances> odometry_twist_variances;
  std::vector<float> ranges_m;  ///< of the lasers, `beams` per robot; infinity for beams that a laser does not have
  std::vector<std::size_t> beams_of;  ///< how many a robot's laser has

  std::vector<double> voice_level_db;       ///< of its own cell; 0 beyond the map
  std::vector<std::uint8_t> voice_heard;    ///< whether a cell within the radius is above 0
  std::vector<base::Point> local_best;      ///< centre of the loudest such cell; the robot's position if there is none
  std::vector<double> local_best_level_db;  ///< 0 if there is none

  std::vector<double> rssi_dbm;             ///< signals, 0 on the diagonal; -infinity for an absent robot
  std::vector<double> link;                 ///< L of eq. (16) by distance [m]; empty: it is rssi_dbm
  std::vector<std::uint8_t> adjacency;      ///< A of eq. (17)
  std::vector<std::uint8_t> endangered;     ///< the links that are below the limit
  std::vector<std::int32_t> hop_count;      ///< C of eq. (18-20); -1 without a path, and for an absent robot
  std::vector<double> fiedler_value;        ///< eq. (33), one per mission
  std::vector<std::int64_t> links_version;  ///< one per mission: grows with each change of links, and of who is present

  std::vector<std::uint64_t> links_source;  ///< who wrote the links of a mission: a `TeamLinks`, or 0

  std::vector<std::uint8_t> happened;  ///< bits of `Happening`, one per mission; only a batch writes them

  /// The place of a mission's first robot in the arrays of robots.
  std::size_t First(std::size_t mission) const { return mission * robots; }
  /// The place of a mission's matrix.
  std::size_t Matrix(std::size_t mission) const { return mission * robots * robots; }

  /// Allocates the matrices, unless they are there: a team whose links nobody asks for has none.
  /// Args: with_link: whether `link` is another matrix than `rssi_dbm`.
  void NeedLinks(bool with_link);

  /// Returns the numbers of one mission alone, which do not keep those of the others in memory.
  /// Throws std::out_of_range if there is no such mission.
  State Of(std::size_t mission) const;

  /// Returns the places of a mission's robots in `map` [m].
  std::vector<base::Point> Positions(std::size_t mission) const;
};

}  // namespace robotteamsim::state
