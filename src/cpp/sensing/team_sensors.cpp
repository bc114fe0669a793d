#include "robotteamsim/sensing/team_sensors.hpp"

#include <cstddef>

namespace robotteamsim::sensing {

Scans ScanTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots, const double* noise) {
  Scans scans(static_cast<Eigen::Index>(robots.size()), laser.NumBeams());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    laser.Report(laser.Scan(world, robots[i]), noise == nullptr ? nullptr : noise + row * laser.NumBeams(),
                 scans.row(row).data());
  }
  return scans;
}

TeamReadings TeamSensors::Read(const world::World& world, const std::vector<Odometry::Noise>& odometry_noise,
                               const std::vector<const double*>& laser_noise) {
  TeamReadings readings;
  readings.odometry = odometry_->Follow(world, odometry_noise);
  readings.twists = world.twists();
  const std::size_t n = world.poses().size();
  readings.ground_truth.reserve(n);
  readings.positions.reserve(n);
  readings.in_contact.resize(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    readings.ground_truth.push_back(ReadingOf(world.poses()[i]));
    readings.positions.push_back({world.poses()[i].x, world.poses()[i].y});
    readings.in_contact[static_cast<Eigen::Index>(i)] = world.in_contact()[i];
  }
  for (std::size_t kind = 0; kind < lasers_.size(); ++kind) {
    readings.scans.push_back(ScanTeam(*lasers_[kind].laser, world, lasers_[kind].robots, laser_noise.at(kind)));
  }
  return readings;
}

}  // namespace robotteamsim::sensing
