#include "robotteamsim/sensing/team_sensors.hpp"

#include <cstddef>

namespace robotteamsim::sensing {

void ScanTeam(const Laser& laser, const world::World& world, const std::vector<int>& robots, const double* noise,
              float* ranges) {
  const int beams = laser.NumBeams();
  for (const int robot : robots) {
    laser.Report(laser.Scan(world, robot), noise, ranges);
    ranges += beams;
    if (noise != nullptr) noise += beams;
  }
}

void TeamSensors::Read(const world::World& world, const std::vector<Odometry::Noise>& odometry_noise,
                       RobotReading* readings, const std::vector<TeamScans>& scans) {
  const std::vector<OdometryReading> odometry = odometry_->Follow(world, odometry_noise);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    readings[i] = {ReadingOf(world.poses()[i]), world.twists()[i], odometry[i], world.in_contact()[i] ? 1.0 : 0.0};
  }
  for (std::size_t kind = 0; kind < lasers_.size(); ++kind) {
    ScanTeam(*lasers_[kind].laser, world, lasers_[kind].robots, scans.at(kind).noise, scans.at(kind).ranges);
  }
}

}  // namespace robotteamsim::sensing
