// The laser of a robot: the first ray sensor of its model.
#pragma once

#include <sensor_msgs/LaserScan.h>

#include <gazebo/physics/PhysicsTypes.hh>
#include <gazebo/sensors/SensorTypes.hh>
#include <ignition/math/Pose3.hh>
#include <optional>
#include <sdf/sdf.hh>

namespace robotteamsim::gazebo_plugins {

class Laser {
 public:
  // Returns the laser, or nothing if the model has no ray sensor. Throws std::invalid_argument: <no_return>.
  static std::optional<Laser> Of(const gazebo::physics::ModelPtr& model, const sdf::ElementPtr& settings);

  // Measures now: Gazebo's own updates come at other times than the odometry. The header is empty.
  sensor_msgs::LaserScan Scan();

  // Its pose in the frame of the model.
  const ignition::math::Pose3d& mount() const { return mount_; }

 private:
  Laser(const gazebo::physics::ModelPtr& model, gazebo::sensors::RaySensorPtr sensor, const gazebo::physics::Link& link,
        double no_return_m);

  // Whether the laser sees the robot's own body, in which it may be.
  void ShowOwnBody(bool visible);

  gazebo::physics::ModelPtr model_;
  gazebo::sensors::RaySensorPtr sensor_;
  ignition::math::Pose3d mount_;
  float no_return_m_;
};

}  // namespace robotteamsim::gazebo_plugins
