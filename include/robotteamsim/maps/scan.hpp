#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/world/fan_caster.hpp"

namespace robotteamsim::maps {

/// A point of a surface, and the direction out of the surface there, of length 1; (0, 0) if it is not known. The two
/// sides of a thin wall differ only in this direction.
struct SurfacePoint {
  base::Point at;
  base::Point normal;
};

/// Returns a point of a surface that moves with the frame of a pose.
SurfacePoint Moved(const SurfacePoint& point, const base::Pose& pose);

/// The same for a point.
base::Point Moved(const base::Point& point, const base::Pose& pose);

/// The beams of one scan, in base_link [m].
struct Scan {
  base::Point laser;                   ///< where the beams begin
  std::vector<SurfacePoint> hits;      ///< where those that returned end
  std::vector<base::Point> free_ends;  ///< up to where those without a return prove free space
};

/// Beams count up to this length [m].
constexpr double kLongestBeam = 100.0;

/// How a laser is read.
struct ScanLayout {
  world::Fan fan;
  double range_min_m = 0.0;  ///< shorter ranges mean nothing
  int most_beams = 181;      ///< of a scan with more, only every n-th beam is used
};

/// Throws std::invalid_argument if the laser has no beams or is to use none, or a number cannot be used.
void Check(const ScanLayout& layout);

/// Throws std::invalid_argument unless there is a range for each beam, and a mask for each or none.
void CheckLengths(const ScanLayout& layout, const std::vector<float>& ranges_m,
                  const std::vector<std::uint8_t>& masked);

/// Returns the beams of a scan. A normal is that of the line between the neighbours of a beam that hit the same
/// surface. Args: ranges_m: one per beam; those that are not below range_max are no returns.
///       masked: nonzero for beams to leave out, such as those that end at a teammate; empty: none.
/// Throws std::invalid_argument as CheckLengths.
Scan ReadScan(const ScanLayout& layout, const std::vector<float>& ranges_m, const std::vector<std::uint8_t>& masked);

}  // namespace robotteamsim::maps
