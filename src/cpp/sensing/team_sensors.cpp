#include "robotteamsim/sensing/team_sensors.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace robotteamsim::sensing {
namespace {

void CheckRanges(const Laser& laser, const std::vector<int>& robots, const base::Table<float>& ranges) {
  if (!ranges.HasShape(robots.size(), static_cast<std::size_t>(laser.NumBeams()))) {
    throw std::invalid_argument("ranges must have one row per robot and one column per beam");
  }
}

void CheckNoise(const Laser& laser, const std::vector<int>& robots, const base::Table<const double>& noise) {
  if (!noise.IsEmpty() && !noise.HasShape(robots.size(), static_cast<std::size_t>(laser.NumBeams()))) {
    throw std::invalid_argument("noise must have one value per beam");
  }
}

}  // namespace

void ScanTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots,
              const base::Table<const double>& noise, const base::Table<float>& ranges) {
  CheckNoise(laser, robots, noise);
  CheckRanges(laser, robots, ranges);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    laser.Report(laser.Scan(world, robots[i]), noise.IsEmpty() ? nullptr : noise.Row(i), ranges.Row(i));
  }
}

std::vector<float> ScanNearest(const Laser& laser, const world::World& world, const std::vector<int>& robots,
                               const std::vector<double>& noise) {
  if (!noise.empty() && noise.size() != robots.size()) {
    throw std::invalid_argument("noise must have one value per robot");
  }
  std::vector<float> nearest(robots.size());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const std::vector<double> ranges = laser.Scan(world, robots[i]);
    laser.Report({*std::min_element(ranges.begin(), ranges.end())}, noise.empty() ? nullptr : &noise[i], &nearest[i]);
  }
  return nearest;
}

void DimTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots, const hazards::Haze& haze,
             const base::Table<float>& ranges) {
  CheckRanges(laser, robots, ranges);
  for (std::size_t i = 0; i < robots.size(); ++i) laser.Dim(world, robots[i], haze, ranges.Row(i));
}

void TeamSensors::Read(const world::World& world, const std::vector<Odometry::Noise>& odometry_noise,
                       const std::vector<base::Table<const double>>& laser_noise, RobotReading* readings,
                       const std::vector<base::Table<float>>& ranges) {
  if (ranges.size() != lasers_.size()) throw std::invalid_argument("each kind of laser must have its ranges");
  if (!laser_noise.empty() && laser_noise.size() != lasers_.size()) {
    throw std::invalid_argument("each kind of laser must have its noise");
  }
  const auto noise_of = [&](std::size_t kind) {
    return laser_noise.empty() ? base::Table<const double>{} : laser_noise[kind];
  };
  for (std::size_t kind = 0; kind < lasers_.size(); ++kind) {
    CheckNoise(*lasers_[kind].laser, lasers_[kind].robots, noise_of(kind));
    CheckRanges(*lasers_[kind].laser, lasers_[kind].robots, ranges[kind]);
  }
  const std::vector<OdometryReading> odometry = odometry_->Follow(world, odometry_noise);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    readings[i] = {ReadingOf(world.poses()[i]), world.twists()[i], odometry[i], world.in_contact()[i] ? 1.0 : 0.0};
  }
  for (std::size_t kind = 0; kind < lasers_.size(); ++kind) {
    ScanTeam(*lasers_[kind].laser, world, lasers_[kind].robots, noise_of(kind), ranges[kind]);
  }
}

}  // namespace robotteamsim::sensing
