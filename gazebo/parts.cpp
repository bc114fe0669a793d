#include "parts.hpp"

#include <gazebo/physics/Link.hh>
#include <gazebo/physics/Model.hh>

namespace robotteamsim::gazebo_plugins {

namespace physics = gazebo::physics;

physics::Link_V LinksOf(const physics::ModelPtr& model) {
  physics::Link_V links = model->GetLinks();
  for (const physics::ModelPtr& nested : model->NestedModels()) {
    const physics::Link_V more = LinksOf(nested);
    links.insert(links.end(), more.begin(), more.end());
  }
  return links;
}

PlanarPose PlaceOf(const physics::ModelPtr& model) {
  const ignition::math::Pose3d pose = model->WorldPose();
  return {pose.Pos().X(), pose.Pos().Y(), pose.Rot().Yaw()};
}

}  // namespace robotteamsim::gazebo_plugins
