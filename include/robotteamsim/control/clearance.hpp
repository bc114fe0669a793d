#pragma once

#include <cstddef>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/simd.hpp"

namespace robotteamsim::control {

/// How a robot's laser looks: beams evenly spread over [angle_min, angle_max], `forward` metres ahead of base_link.
struct LaserLayout {
  int beams = 181;
  double angle_min = -1.5707963267948966;
  double angle_max = 1.5707963267948966;
  double forward = 0.0;
  double range_max = 5.0;
};

/// The ranges of one scan [m], in the order of its beams, wherever they are kept.
struct Ranges {
  Ranges(const float* first, std::size_t count) : data(first), size(count) {}
  Ranges(const std::vector<float>& ranges) : Ranges(ranges.data(), ranges.size()) {}  // NOLINT: they are ranges

  const float* data;
  std::size_t size;
};

/// A heading [rad, base_link], with what is asked of it again and again.
struct Direction {
  explicit Direction(double heading);

  double heading, cos, sin;
};

/// How far a disc of `radius` [m] can move from (0, 0) in a direction before it touches a hit, at most `max_distance`
/// [m]. A hit that is inside the disc already counts only when the way leads towards it (within 60 degrees), so that a
/// robot can always slide along a wall or leave it. `simd` changes no bit of it.
double FreeDistanceAmong(const std::vector<base::Point>& hits, const Direction& direction, double radius,
                         double max_distance, base::Simd simd);

/// What one robot's laser says about the room around it.
class ScanClearance {
 public:
  explicit ScanClearance(const LaserLayout& layout);

  /// What the beams hit nearer than `max_distance` [m] to base_link, in base_link; beams without return are left out.
  std::vector<base::Point> Hits(const Ranges& ranges, double max_distance) const;

  /// The same, in the place of what `hits` held.
  void FindHits(const Ranges& ranges, double max_distance, std::vector<base::Point>* hits) const;

  /// The FreeDistanceAmong all hits from base_link towards `heading` [rad, base_link].
  double FreeDistance(const Ranges& ranges, double heading, double radius, double max_distance) const;

  /// The same for several directions.
  std::vector<double> FreeDistances(const Ranges& ranges, const std::vector<Direction>& directions, double radius,
                                    double max_distance) const;

 private:
  LaserLayout layout_;
  std::vector<base::Point> directions_;  ///< of beams
};

/// How a robot passes obstacles.
struct SidestepParameters {
  double left_penalty =
      0.25;  ///< cost of a heading to the left, so that robots that meet head-on both keep right [rad]
  double change_penalty = 0.35;  ///< cost of the other side than in the last step, against dithering [rad]
  double ahead = 1.6;            ///< a wanted heading beyond this is turned to on the spot [rad]
};

/// Finds one robot's way past what its laser sees. Robots that meet head-on both keep right, and one that has begun to
/// pass an obstacle on one side stays on it.
class Sidestepper {
 public:
  /// `headings` [rad, base_link] are those that it may take instead of the wanted one; at least one.
  Sidestepper(ScanClearance clearance, const std::vector<double>& headings, const SidestepParameters& parameters);

  /// A heading [rad, base_link] and how far it is free for a disc of `radius` [m], at most `needed` [m].
  struct FreeHeading {
    double heading;
    double free;
  };

  /// The wanted heading where it is free as far as needed, or behind; else the one nearest to it that is free so far;
  /// else the one that is free the farthest.
  FreeHeading Find(const Ranges& ranges, double wanted, double radius, double needed);

 private:
  ScanClearance clearance_;
  std::vector<Direction> directions_;
  SidestepParameters parameters_;
  int passing_side_ = 0;
  std::vector<base::Point> hits_;  ///< of the last scan: kept, as its memory serves the next one
};

}  // namespace robotteamsim::control
