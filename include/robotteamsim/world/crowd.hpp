#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/nearby_edges.hpp"
#include "robotteamsim/world/solid.hpp"

namespace robotteamsim::world {

/// The parameters of the collision-free speed model [tordeux2016]: `people` of a scenario, which has the defaults.
struct CrowdParameters {
  double time_gap_s = 0.0;          ///< T: people keep this time to the one ahead
  double neighbour_strength = 0.0;  ///< a: how far a neighbour turns the direction aside
  double neighbour_range_m = 0.0;   ///< D: over which this effect fades
  double wall_strength = 0.0;       ///< the same of a wall
  double wall_range_m = 0.0;
  double longest_substep_s = 0.0;  ///< a step is divided into equal substeps that are not longer
};

/// Someone who walks to a target in a straight line, around others and along walls.
struct Walker {
  base::Point position;    ///< [m, map]
  base::Point target;      ///< [m, map]; at the target they stand
  double speed_mps = 0.0;  ///< with nobody ahead
  double radius_m = 0.2;
};

/// A body that walkers avoid: a robot, or someone who stands.
struct Bystander {
  base::Point position;  ///< [m, map]
  double radius_m = 0.2;
};

/// People on a floor plan who walk by the collision-free speed model of Tordeux, Chraibi and Seyfried.
///
/// The speed follows from the gap to the nearest one ahead, V(s) = min(v0, max(0, s / T)), the direction from the
/// target and the repulsion of neighbours and walls. Walls and closed leaves also stop the part of a step that would
/// enter them, because the published model only turns people away from walls.
class Crowd {
 public:
  /// Leaves of all doors count as instant: only a closed door is in the way.
  /// Throws std::invalid_argument if a parameter is out of range.
  Crowd(const std::vector<Solid>& solids, std::vector<Door> doors, const CrowdParameters& parameters);

  /// Returns the positions after a time [s], in the order of the walkers. All walk at once, so the order does not
  /// matter. Args: closed: whether each door is closed. Throws std::invalid_argument if a number is out of range, or
  /// `closed` has another length than the doors.
  std::vector<base::Point> Step(std::vector<Walker> walkers, const std::vector<Bystander>& others,
                                const std::vector<bool>& closed, double time_s) const;

 private:
  base::Point NextPosition(const std::vector<Walker>& walkers, std::size_t index, const std::vector<Bystander>& others,
                           const std::vector<base::Segment>& walls, double time_s) const;
  std::vector<base::Segment> WallsNear(const Walker& walker, const std::vector<bool>& closed) const;

  CrowdParameters parameters_;
  std::size_t num_doors_;
  NearbyEdges edges_;
};

}  // namespace robotteamsim::world
