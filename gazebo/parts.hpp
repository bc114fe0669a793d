// The parts of a model, those of models in it included.
#pragma once

#include <gazebo/physics/PhysicsTypes.hh>

#include "planar.hpp"

namespace robotteamsim::gazebo_plugins {

gazebo::physics::Link_V LinksOf(const gazebo::physics::ModelPtr& model);

// Where a model is on the floor; height, roll and pitch are left out.
PlanarPose PlaceOf(const gazebo::physics::ModelPtr& model);

}  // namespace robotteamsim::gazebo_plugins
