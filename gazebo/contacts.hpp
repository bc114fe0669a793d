// What a robot has touched since the last step, and in which directions.
#pragma once

#include <gazebo/physics/PhysicsTypes.hh>
#include <vector>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

class Contacts {
 public:
  explicit Contacts(const gazebo::physics::ModelPtr& model);

  // Adds the contacts of a physics step, except those with the floor.
  void Note();
  // Returns the directions in the frame of the model, ascending, nearby ones merged [rad]; starts the next step.
  std::vector<double> TakeAngles();

 private:
  void Add(const gazebo::physics::Contact& contact, const PlanarPose& place);

  gazebo::physics::ModelPtr model_;
  std::vector<double> angles_rad_;
};

}  // namespace robotteamsim::gazebo_plugins
