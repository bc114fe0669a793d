// The limits of a drive.
//
//   <limits>
//     <speed>0.7</speed>                          largest speed [m/s]
//     <turn>2</turn>                              largest rate of turning [rad/s]
//     <acceleration>2</acceleration>              largest change of speed [m/s^2]
//     <turn_acceleration>8</turn_acceleration>    largest change of turning [rad/s^2]
//     <turning_radius>0</turning_radius>          smallest radius of a curve [m]; above 0 for a car
//     <sideways>true</sideways>                   whether it can move sideways
//   </limits>
//
// All elements are optional. Without one there is no such limit.
#pragma once

#include <limits>
#include <sdf/sdf.hh>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

class Limits {
 public:
  // Throws std::invalid_argument: a value is negative.
  explicit Limits(const sdf::ElementPtr& settings);

  // Returns the velocity that a drive has after some time if it had another one before and obeys a command.
  PlanarTwist Next(const PlanarTwist& before, const PlanarTwist& command, double duration_s) const;

 private:
  PlanarTwist Possible(const PlanarTwist& command) const;

  double speed_mps_ = std::numeric_limits<double>::infinity();
  double turn_radps_ = std::numeric_limits<double>::infinity();
  double acceleration_mps2_ = std::numeric_limits<double>::infinity();
  double turn_acceleration_radps2_ = std::numeric_limits<double>::infinity();
  double turning_radius_m_ = 0.0;
  bool sideways_ = true;
};

}  // namespace robotteamsim::gazebo_plugins
