#include "robotteamsim/sensing/team_sensors.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace robotteamsim::sensing {

TeamSensors::TeamSensors(std::vector<Lasers> lasers, TeamOdometry odometry)
    : lasers_(std::move(lasers)), odometry_(std::move(odometry)) {
  std::vector<int> carried(odometry_.size());
  for (const Lasers& kind : lasers_) {
    if (kind.fan.beams < 1 || (kind.caster != nullptr && kind.caster->fan().beams != kind.fan.beams)) {
      throw std::invalid_argument("a fan must have beams, and its caster as many");
    }
    beams_ = std::max(beams_, static_cast<std::size_t>(kind.fan.beams));
    for (const int robot : kind.robots) {
      if (robot < 0 || robot >= static_cast<int>(carried.size())) throw std::invalid_argument("no such robot");
      ++carried[robot];
    }
  }
  for (const int count : carried) {
    if (count != 1) throw std::invalid_argument("each robot must have one laser");
  }
}

void TeamSensors::AddNoise(const base::Table<const double>& noise) {
  if (noise.cols != 3 * robots()) throw std::invalid_argument("noise must have a row of three numbers per robot");
  const std::size_t used = noise_.size() - steps_left_ * noise.cols;
  noise_.erase(noise_.begin(), noise_.begin() + static_cast<std::ptrdiff_t>(used));
  noise_.insert(noise_.end(), noise.data, noise.data + noise.rows * noise.cols);
  steps_left_ += noise.rows;
}

void TeamSensors::SetRangeNoise(const base::Table<const double>& noise_m) {
  if (!noise_m.IsEmpty() && !noise_m.HasShape(robots(), beams_)) {
    throw std::invalid_argument("the noise of ranges must have one row per robot and one column per beam");
  }
  noise_m_.assign(noise_m.data, noise_m.data + noise_m.rows * noise_m.cols);
}

void TeamSensors::Restart(int robot, const base::Table<const double>& noise) {
  if (!noise.HasShape(steps_left_, 3)) throw std::invalid_argument("noise must have a row of three numbers per step");
  odometry_.Restart(robot);
  const std::size_t cols = 3 * robots();
  double* row = noise_.data() + noise_.size() - steps_left_ * cols + 3 * static_cast<std::size_t>(robot);
  for (std::size_t step = 0; step < steps_left_; ++step, row += cols) std::copy_n(noise.Row(step), 3, row);
}

base::Table<const double> TeamSensors::NextNoise() {
  if (steps_left_ == 0) throw std::invalid_argument("no random numbers are left");
  const double* const row = noise_.data() + noise_.size() - steps_left_ * 3 * robots();
  --steps_left_;
  return {row, robots(), 3};
}

void TeamSensors::CheckShape(const state::State& state, std::size_t mission) const {
  if (mission >= state.missions || robots() > state.robots || beams_ > state.beams) {
    throw std::invalid_argument("the state must have room for the mission, its robots and their beams");
  }
}

void TeamSensors::Read(const world::World& world, state::State* state, std::size_t mission) {
  CheckShape(*state, mission);
  const std::size_t first = state->First(mission);
  odometry_.Step(world.motions(), world.twists(), NextNoise(), state, first);
  for (std::size_t i = 0; i < robots(); ++i) {
    state->true_pose[first + i] = state::ReadingOf(world.poses()[i]);
    state->true_twist[first + i] = world.twists()[i];
    state->contact[first + i] = world.in_contact()[i] ? 1 : 0;
    state->contact_angles[first + i] = world.contact_angles(static_cast<int>(i));
  }
  for (const Lasers& kind : lasers_) {
    if (kind.caster == nullptr) throw std::invalid_argument("these lasers are in another world");
    for (const int robot : kind.robots) {
      const std::vector<double> ranges_m = kind.caster->Cast(world, robot);
      Report(kind, robot, ranges_m.data(), world.poses()[robot], state, first);
    }
  }
}

void TeamSensors::Read(const Motion& motion, const std::vector<base::Table<const double>>& ranges_m,
                       state::State* state, std::size_t mission) {
  CheckShape(*state, mission);
  if (motion.poses.size() != robots() || motion.in_contact.size() != robots() ||
      motion.contact_angles.size() != robots() || ranges_m.size() != lasers_.size()) {
    throw std::invalid_argument("there must be one row per robot, and one table of ranges per kind of laser");
  }
  const std::size_t first = state->First(mission);
  odometry_.Step(motion.motions, motion.twists, NextNoise(), state, first);
  for (std::size_t i = 0; i < robots(); ++i) {
    state->true_pose[first + i] = state::ReadingOf(motion.poses[i]);
    state->true_twist[first + i] = motion.twists[i];
    state->contact[first + i] = motion.in_contact[i] ? 1 : 0;
    state->contact_angles[first + i] = motion.contact_angles[i];
  }
  for (std::size_t kind = 0; kind < lasers_.size(); ++kind) {
    const Lasers& lasers = lasers_[kind];
    if (!ranges_m[kind].HasShape(lasers.robots.size(), static_cast<std::size_t>(lasers.fan.beams))) {
      throw std::invalid_argument("ranges must have one row per robot and one column per beam");
    }
    for (std::size_t i = 0; i < lasers.robots.size(); ++i) {
      const int robot = lasers.robots[i];
      Report(lasers, robot, ranges_m[kind].Row(i), motion.poses[robot], state, first);
    }
  }
}

void TeamSensors::Report(const Lasers& lasers, std::size_t robot_id, const double* ranges_m, const base::Pose& pose,
                         state::State* state, std::size_t first_row) const {
  const auto beams = static_cast<std::size_t>(lasers.fan.beams);
  float* const row = &state->ranges_m[(first_row + robot_id) * state->beams];
  const base::Table<float> reported{row, 1, beams};
  base::Table<const double> added;
  if (!noise_m_.empty()) added = {&noise_m_[robot_id * beams_], 1, beams};
  sensing::Report(lasers.limits, {ranges_m, 1, beams}, added, reported);
  if (haze_ != nullptr) Dim(lasers.fan, {pose}, *haze_, lasers.limits.no_return_m, reported);
  std::fill(row + beams, row + state->beams, std::numeric_limits<float>::infinity());
  state->beams_of[first_row + robot_id] = beams;
}

}  // namespace robotteamsim::sensing
