#include "contacts.hpp"

#include <algorithm>
#include <cmath>
#include <gazebo/physics/physics.hh>
#include <utility>

#include "parts.hpp"

namespace robotteamsim::gazebo_plugins {
namespace {

namespace physics = gazebo::physics;

// Contacts in nearer directions are one.
constexpr double kSamePlaceRad = 0.05;
// A normal that is steeper belongs to the floor, or to something on which the robot stands.
constexpr double kFloor = 0.7;

bool IsOf(const physics::Collision* collision, const physics::ModelPtr& model) {
  // The outermost model, because a part may be a model itself.
  return collision != nullptr && collision->GetLink() && collision->GetLink()->GetParentModel() == model;
}

}  // namespace

Contacts::Contacts(const physics::ModelPtr& model) : model_(model) {
  // Otherwise it has contacts only while another program subscribes to them.
  model->GetWorld()->Physics()->GetContactManager()->SetNeverDropContacts(true);
}

void Contacts::Note() {
  const physics::ContactManager* manager = model_->GetWorld()->Physics()->GetContactManager();
  const PlanarPose place = PlaceOf(model_);
  for (unsigned int i = 0; i < manager->GetContactCount(); ++i) {
    const physics::Contact* contact = manager->GetContact(i);
    if (IsOf(contact->collision1, model_) != IsOf(contact->collision2, model_)) Add(*contact, place);
  }
}

void Contacts::Add(const physics::Contact& contact, const PlanarPose& place) {
  for (int i = 0; i < contact.count; ++i) {
    if (std::abs(contact.normals[i].Z()) > kFloor) continue;
    const double x_m = contact.positions[i].X() - place.x_m;
    const double y_m = contact.positions[i].Y() - place.y_m;
    angles_rad_.push_back(std::remainder(std::atan2(y_m, x_m) - place.yaw_rad, 2.0 * M_PI));
  }
}

std::vector<double> Contacts::TakeAngles() {
  std::vector<double> angles_rad = std::exchange(angles_rad_, {});
  std::sort(angles_rad.begin(), angles_rad.end());
  const auto is_same = [](double first, double next) { return next - first < kSamePlaceRad; };
  angles_rad.erase(std::unique(angles_rad.begin(), angles_rad.end(), is_same), angles_rad.end());
  if (angles_rad.size() > 1 && angles_rad.front() + 2.0 * M_PI - angles_rad.back() < kSamePlaceRad)
    angles_rad.pop_back();
  return angles_rad;
}

}  // namespace robotteamsim::gazebo_plugins
