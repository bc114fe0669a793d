#include "laser.hpp"

#include <boost/thread/recursive_mutex.hpp>
#include <gazebo/physics/physics.hh>
#include <gazebo/sensors/sensors.hh>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "parts.hpp"

namespace robotteamsim::gazebo_plugins {

namespace physics = gazebo::physics;
namespace sensors = gazebo::sensors;

std::optional<Laser> Laser::Of(const physics::ModelPtr& model, const sdf::ElementPtr& settings) {
  const std::string no_return = settings->Get<std::string>("no_return", "range_max").first;
  if (no_return != "range_max" && no_return != "inf") {
    throw std::invalid_argument("<no_return>: '" + no_return + "'; expected range_max or inf");
  }
  for (const physics::LinkPtr& link : LinksOf(model)) {
    for (unsigned int i = 0; i < link->GetSensorCount(); ++i) {
      const sensors::SensorPtr sensor = sensors::SensorManager::Instance()->GetSensor(link->GetSensorName(i));
      if (auto ray = std::dynamic_pointer_cast<sensors::RaySensor>(sensor)) {
        const double no_return_m = no_return == "inf" ? std::numeric_limits<double>::infinity() : ray->RangeMax();
        return Laser(model, std::move(ray), *link, no_return_m);
      }
    }
  }
  return std::nullopt;
}

Laser::Laser(const physics::ModelPtr& model, sensors::RaySensorPtr sensor, const physics::Link& link,
             double no_return_m)
    : model_(model),
      sensor_(std::move(sensor)),
      mount_(model->WorldPose().Inverse() * link.WorldPose() * sensor_->Pose()),
      no_return_m_(static_cast<float>(no_return_m)) {
  sensor_->SetActive(false);
}

sensor_msgs::LaserScan Laser::Scan() {
  {
    const boost::recursive_mutex::scoped_lock lock(*model_->GetWorld()->Physics()->GetPhysicsUpdateMutex());
    ShowOwnBody(false);
    sensor_->Update(/*_force=*/true);
    ShowOwnBody(true);
  }
  sensor_msgs::LaserScan scan;
  scan.angle_min = static_cast<float>(sensor_->AngleMin().Radian());
  scan.angle_max = static_cast<float>(sensor_->AngleMax().Radian());
  scan.angle_increment = static_cast<float>(sensor_->AngleResolution());
  scan.range_min = static_cast<float>(sensor_->RangeMin());
  scan.range_max = static_cast<float>(sensor_->RangeMax());
  std::vector<double> ranges_m;
  sensor_->Ranges(ranges_m);
  // Of several rows of beams, one above the other, the first.
  ranges_m.resize(static_cast<std::size_t>(sensor_->RangeCount()));
  for (const double range_m : ranges_m) {
    const bool is_return = range_m < sensor_->RangeMax();
    scan.ranges.push_back(is_return ? std::max(static_cast<float>(range_m), scan.range_min) : no_return_m_);
  }
  return scan;
}

void Laser::ShowOwnBody(bool visible) {
  // Beams are in the category of sensors and collide with nothing in it.
  const unsigned int category = visible ? GZ_ALL_COLLIDE : GZ_SENSOR_COLLIDE;
  const unsigned int others = visible ? GZ_ALL_COLLIDE : ~GZ_SENSOR_COLLIDE;
  for (const physics::LinkPtr& link : LinksOf(model_)) {
    for (const physics::CollisionPtr& collision : link->GetCollisions()) {
      collision->SetCategoryBits(category);
      collision->SetCollideBits(others);
    }
  }
}

}  // namespace robotteamsim::gazebo_plugins
