#pragma once

#include <cmath>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/table.hpp"
#include "robotteamsim/world/nearby_edges.hpp"
#include "robotteamsim/world/sorted_beams.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::world {

/// Beams from one point of a robot, at equal angles.
struct Fan {
  int beams = 181;
  double angle_min_rad = 0.0;  ///< of the first beam, in base_link
  double angle_max_rad = 0.0;  ///< of the last beam
  double forward_m = 0.0;      ///< ahead of base_link
  double left_m = 0.0;         ///< to the left of base_link
  double range_max_m = 5.0;

  /// Returns where the beams of a robot begin.
  base::Point Origin(const base::Pose& robot) const {
    const double cos = std::cos(robot.yaw), sin = std::sin(robot.yaw);
    return {robot.x + forward_m * cos - left_m * sin, robot.y + forward_m * sin + left_m * cos};
  }
};

/// Casts the beams of a fan: walls, blocks, closed doors, objects and other robots return a beam; its own robot does
/// not. A fan inside one of them, such as one at the front of a robot that is pressed against a wall, measures 0.
///
/// Each near edge and robot is projected onto the beams and shortens those that meet it; this is cheaper than testing
/// each beam against all of them.
class FanCaster {
 public:
  /// Args: solids, doors: of the worlds in which it will cast.
  /// Throws std::invalid_argument if there are no beams, the range is not positive, or an angle is not finite.
  FanCaster(const Fan& fan, const std::vector<Solid>& solids, const std::vector<Door>& doors);
  FanCaster(const Fan& fan, const World& world) : FanCaster(fan, world.solids(), world.doors()) {}

  const Fan& fan() const { return fan_; }

  /// Returns how far each beam of a robot reaches [m]; infinity where nothing is within range_max_m.
  std::vector<double> Cast(const World& world, int robot) const;

  /// Writes how far the beams of some robots reach [m]: one row per robot, one column per beam.
  /// Throws std::invalid_argument if the table has another shape.
  void Cast(const World& world, const std::vector<int>& robots, const base::Table<double>& ranges_m) const;

 private:
  /// The ranges found so far, in the order of the beams.
  class View;

  Fan fan_;
  SortedBeams beams_;
  NearbyEdges edges_;
};

}  // namespace robotteamsim::world
