#pragma once

#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/control/clearance.hpp"

namespace robotteamsim::control {

/// Finds free places around a robot from some of its beams.
class Surroundings {
 public:
  /// Args: laser: of each `stride`-th beam of a scan; headings_rad: of the candidate places [rad, base_link].
  Surroundings(const LaserLayout& laser, int stride, double sensing_radius_m, const std::vector<double>& headings_rad);

  /// Returns, of the free places at half the sensing radius and at the whole radius and the robot's own, the place
  /// farthest from all hits [m, map]; nothing without a hit within the radius.
  /// Args: pose: of the robot.  Throws std::invalid_argument if it is not finite.
  std::optional<base::Point> ClearestPlace(const base::Pose& pose, const Ranges& ranges) const;

 private:
  ScanClearance clearance_;
  std::size_t stride_;
  double sensing_radius_m_;
  std::vector<Direction> directions_;
};

}  // namespace robotteamsim::control
