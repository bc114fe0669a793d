#include "limits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace robotteamsim::gazebo_plugins {
namespace {

void Read(const sdf::ElementPtr& settings, const std::string& name, double* value) {
  *value = settings->Get<double>(name, *value).first;
  if (!(*value >= 0.0))
    throw std::invalid_argument("<" + name + ">: " + std::to_string(*value) + "; expected at least 0");
}

double Approached(double before, double wanted, double largest_change) {
  return before + std::clamp(wanted - before, -largest_change, largest_change);
}

}  // namespace

Limits::Limits(const sdf::ElementPtr& settings) {
  if (!settings->HasElement("limits")) return;
  const sdf::ElementPtr limits = settings->GetElement("limits");
  Read(limits, "speed", &speed_mps_);
  Read(limits, "turn", &turn_radps_);
  Read(limits, "acceleration", &acceleration_mps2_);
  Read(limits, "turn_acceleration", &turn_acceleration_radps2_);
  Read(limits, "turning_radius", &turning_radius_m_);
  sideways_ = limits->Get<bool>("sideways", true).first;
}

PlanarTwist Limits::Next(const PlanarTwist& before, const PlanarTwist& command, double duration_s) const {
  const PlanarTwist wanted = Possible(command);
  const double forward_mps = wanted.forward_mps - before.forward_mps;
  const double left_mps = wanted.left_mps - before.left_mps;
  // A drive that cannot move sideways does not slide; of others, the length of the planar acceleration is limited.
  const double change_mps = sideways_ ? std::hypot(forward_mps, left_mps) : std::abs(forward_mps);
  const double largest_mps = acceleration_mps2_ * duration_s;
  const double share = change_mps > largest_mps ? largest_mps / change_mps : 1.0;
  PlanarTwist next{before.forward_mps + share * forward_mps, sideways_ ? before.left_mps + share * left_mps : 0.0,
                   Approached(before.turn_radps, wanted.turn_radps, turn_acceleration_radps2_ * duration_s)};
  if (turning_radius_m_ > 0.0) {
    const double largest_radps = std::abs(next.forward_mps) / turning_radius_m_;
    next.turn_radps = std::clamp(next.turn_radps, -largest_radps, largest_radps);
  }
  return next;
}

PlanarTwist Limits::Possible(const PlanarTwist& command) const {
  const double left_mps = sideways_ ? command.left_mps : 0.0;
  const double speed_mps = std::hypot(command.forward_mps, left_mps);
  const double share = speed_mps > speed_mps_ ? speed_mps_ / speed_mps : 1.0;
  return {share * command.forward_mps, share * left_mps, std::clamp(command.turn_radps, -turn_radps_, turn_radps_)};
}

}  // namespace robotteamsim::gazebo_plugins
