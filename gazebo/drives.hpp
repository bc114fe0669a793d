// How a command moves a robot: its body directly, or its wheels.
#pragma once

#include <gazebo/physics/PhysicsTypes.hh>
#include <memory>
#include <sdf/sdf.hh>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

class Drive {
 public:
  virtual ~Drive() = default;

  // Before each physics step.
  virtual void Apply(const PlanarTwist& command, double duration_s) = 0;
  // After each physics step: returns the motion in it as the wheels measure it. Args: true_motion: that of the body.
  virtual PlanarPose Measured(const PlanarPose& true_motion, double duration_s) const = 0;
};

// Returns the drive that <drive> selects. Throws std::invalid_argument.
//   velocity (default): the body has the velocity of the command [dissertation, Appendix 1]; it has no weight, so that
//     neither friction nor a bump changes its height or speed.
//   wheels: motors of at most <max_torque> (5 Nm) turn <left_joint> and <right_joint>.
// Both stay within <limits>, see limits.hpp.
std::unique_ptr<Drive> MakeDrive(const gazebo::physics::ModelPtr& model, const sdf::ElementPtr& settings);

}  // namespace robotteamsim::gazebo_plugins
