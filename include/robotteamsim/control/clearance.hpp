#pragma once

#include <vector>

#include "robotteamsim/plan/types.hpp"

namespace robotteamsim {

/// How a robot's laser looks: beams evenly spread over [angle_min, angle_max], `forward` metres ahead of base_link.
struct LaserLayout {
  int beams = 181;
  double angle_min = -1.5707963267948966;
  double angle_max = 1.5707963267948966;
  double forward = 0.0;
  double range_max = 5.0;
};

/// What one robot's laser says about the room around it.
class ScanClearance {
 public:
  explicit ScanClearance(const LaserLayout& layout);

  /// What the beams hit nearer than `max_distance` [m] to base_link, in base_link; beams without return are left out.
  std::vector<Point> Hits(const std::vector<float>& ranges, double max_distance) const;

  /// How far a disc of `radius` [m] can move from base_link towards `heading` [rad, base_link] before it touches a
  /// hit, at most `max_distance` [m]. A hit that is inside the disc already counts only when the way leads towards it
  /// (within 60 degrees), so that a robot can always slide along a wall or leave it.
  double FreeDistance(const std::vector<float>& ranges, double heading, double radius, double max_distance) const;

  /// The same for several headings.
  std::vector<double> FreeDistances(const std::vector<float>& ranges, const std::vector<double>& headings,
                                    double radius, double max_distance) const;

 private:
  LaserLayout layout_;
  std::vector<Point> directions_;
};

}  // namespace robotteamsim
