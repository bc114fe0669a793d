#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::control {

/// The layout of a robot's laser: beams evenly spaced over [angle_min_rad, angle_max_rad].
struct LaserLayout {
  int beams = 181;
  double angle_min_rad = -1.5707963267948966;
  double angle_max_rad = 1.5707963267948966;
  double forward_m = 0.0;  ///< ahead of base_link
  double range_max_m = 5.0;
  double left_m = 0.0;  ///< left of base_link
};

/// A view of the ranges of one scan [m], in the order of its beams.
struct Ranges {
  Ranges(const float* first, std::size_t count) : data(first), size(count) {}
  Ranges(const std::vector<float>& ranges) : Ranges(ranges.data(), ranges.size()) {}  // NOLINT: implicit on purpose

  const float* data;
  std::size_t size;
};

/// A heading [rad, base_link] with its cosine and sine.
struct Direction {
  explicit Direction(double heading_rad);

  double heading_rad, cos, sin;
};

/// Free space around a robot, from its laser scans.
class ScanClearance {
 public:
  explicit ScanClearance(const LaserLayout& layout);

  /// Returns the hits nearer than `max_distance_m` to base_link, in base_link; beams without a return are left out.
  std::vector<base::Point> Hits(const Ranges& ranges, double max_distance_m) const;

  /// The same, replacing the contents of `hits`.
  void FindHits(const Ranges& ranges, double max_distance_m, std::vector<base::Point>* hits) const;

  /// Returns how far a disc of `radius_m` can move from base_link towards `heading_rad` [rad, base_link] before it
  /// touches a hit, at most `max_distance_m`. A hit inside the disc counts only if the motion leads towards it (within
  /// 60 degrees), so that a robot can always slide along a wall or leave it.
  double FreeDistance(const Ranges& ranges, double heading_rad, double radius_m, double max_distance_m) const;

  /// The same for several directions.
  std::vector<double> FreeDistances(const Ranges& ranges, const std::vector<Direction>& directions, double radius_m,
                                    double max_distance_m) const;

 private:
  LaserLayout layout_;
  std::vector<base::Point> directions_;  ///< of beams
};

/// How a robot passes obstacles.
struct SidestepParameters {
  double left_penalty = 0.0;    ///< cost of a heading to the left: robots that meet head-on both keep right [rad]
  double change_penalty = 0.0;  ///< cost of changing the side, against dithering [rad]
  double ahead_rad = 0.0;       ///< the robot turns on the spot to desired headings beyond this
};

/// Finds headings past the obstacles that a robot's laser sees. Robots that meet head-on both keep right, and a robot
/// that has begun to pass an obstacle on one side stays on that side.
class Sidestepper {
 public:
  /// Args: headings_rad: alternatives to the desired heading [rad, base_link]; at least one.
  Sidestepper(ScanClearance clearance, const std::vector<double>& headings_rad, const SidestepParameters& parameters);

  /// A heading [rad, base_link] and how far it is free for a disc of `radius_m`, at most `needed_m`.
  struct FreeHeading {
    double heading_rad;
    double free_m;
  };

  /// Returns the desired heading if it is free as far as needed, or points backwards; else the nearest heading that is;
  /// else the heading that is free the farthest.
  FreeHeading Find(const Ranges& ranges, double wanted_rad, double radius_m, double needed_m);

 private:
  ScanClearance clearance_;
  std::vector<Direction> directions_;
  SidestepParameters parameters_;
  int passing_side_ = 0;
  std::vector<base::Point> hits_;  ///< of the last scan; a member, so that its memory is reused
};

}  // namespace robotteamsim::control
