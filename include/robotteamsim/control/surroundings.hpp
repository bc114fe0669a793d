#pragma once

#include <optional>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/control/clearance.hpp"

namespace robotteamsim::control {

/// Finds where there is room around a robot, among what some of its beams see.
class Surroundings {
 public:
  /// `clearance` reads each `stride`-th beam of a scan. Places are looked for along `headings` [rad, base_link].
  Surroundings(ScanClearance clearance, int stride, double sensing_radius, const std::vector<double>& headings);

  /// Of the places seen free at half the sensing radius and at all of it, and the robot's own, the one farthest from
  /// what the beams hit [m, base_link]; nothing where they hit nothing within the radius.
  std::optional<base::Point> ClearestPlace(const Ranges& ranges) const;

 private:
  ScanClearance clearance_;
  std::size_t stride_;
  double sensing_radius_;
  std::vector<Direction> directions_;
};

}  // namespace robotteamsim::control
