#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/sensing/beam_fan.hpp"
#include "robotteamsim/world/nearby_edges.hpp"
#include "robotteamsim/world/world.hpp"

namespace robotteamsim::sensing {

/// The geometry of a planar laser range finder.
struct LaserModel {
  int beams = 181;
  double angle_min = 0.0;  ///< of the first beam, in base_link [rad]
  double angle_max = 0.0;  ///< of the last beam [rad]
  double forward = 0.0;    ///< ahead of base_link [m]
  double range_min = 0.0;  ///< [m]
  double range_max = 5.0;  ///< [m]
  double too_near = 0.0;   ///< reported for a range below range_min [m]
  double no_return = 5.0;  ///< reported if nothing is within range_max [m]
  double left = 0.0;       ///< to the left of base_link [m]
};

/// Scans a world: walls, blocks, closed doors, objects and other robots return a beam; the laser's own robot does not.
/// A laser inside one of them, such as one at the front of a robot that is pressed against a wall, measures 0.
///
/// Each near edge and robot is projected onto the beams and shortens those that meet it; this is cheaper than testing
/// each beam against all of them.
class Laser {
 public:
  /// Args: solids, doors: of the worlds that it will scan.
  /// Throws std::invalid_argument if there are no beams, the ranges are not positive and ascending, or an angle is not
  /// finite.
  Laser(const LaserModel& model, const std::vector<world::Solid>& solids, const std::vector<world::Door>& doors);
  Laser(const LaserModel& model, const world::World& world) : Laser(model, world.solids(), world.doors()) {}

  int NumBeams() const { return model_.beams; }

  /// Returns the range of each beam of a robot's laser [m]; infinity where nothing is within range_max.
  std::vector<double> Scan(const world::World& world, int robot) const;

  /// Writes the reported ranges of a scan [m]. Args: noise: added to each range [m]; null: none.
  void Report(const std::vector<double>& ranges, const double* noise, float* report) const;

  /// Removes the returns of a scan that smoke hides from a robot's laser. Args: report: the reported ranges [m].
  void Dim(const world::World& world, int robot, const hazards::Haze& haze, float* report) const;

 private:
  /// The ranges found so far, in the order of the fan.
  class View;

  using ReportWriter = void (*)(const LaserModel& model, const double* ranges, const double* noise, std::size_t beams,
                                float* report);

  LaserModel model_;
  ReportWriter write_report_;  ///< for this machine
  BeamFan fan_;
  world::NearbyEdges edges_;
};

}  // namespace robotteamsim::sensing
