#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "robotteamsim/maps/scan.hpp"

namespace robotteamsim::maps {

using Walls = std::vector<base::Segment>;

/// The four walls of a rectangle.
inline Walls Rectangle(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}}, {{x1, y0}, {x1, y1}}, {{x1, y1}, {x0, y1}}, {{x0, y1}, {x0, y0}}};
}

/// A laser in the middle of the robot that looks all around.
inline world::Fan RoundFan(double range_max_m, int beams = 181) {
  const double pi = std::acos(-1.0);
  return {beams, -pi, pi, 0.0, 0.0, range_max_m};
}

/// How far walls are along the beams of a laser in the middle of the robot; range_max_m where there are none.
inline std::vector<float> Ranges(const world::Fan& fan, const Walls& walls, const base::Pose& pose) {
  std::vector<float> ranges;
  const double step = (fan.angle_max_rad - fan.angle_min_rad) / (fan.beams - 1);
  for (int beam = 0; beam < fan.beams; ++beam) {
    const double angle = pose.yaw + fan.angle_min_rad + beam * step;
    const double dx = std::cos(angle), dy = std::sin(angle);
    double range = fan.range_max_m;
    for (const auto& [a, b] : walls) {
      const double wx = b.x - a.x, wy = b.y - a.y, cross = dx * wy - dy * wx;
      if (std::abs(cross) < 1e-12) continue;
      const double along = ((a.x - pose.x) * wy - (a.y - pose.y) * wx) / cross;
      const double on_wall = ((a.x - pose.x) * dy - (a.y - pose.y) * dx) / cross;
      if (along > 0.0 && on_wall >= 0.0 && on_wall <= 1.0) range = std::min(range, along);
    }
    ranges.push_back(static_cast<float>(range));
  }
  return ranges;
}

inline Scan ScanIn(const Walls& walls, const base::Pose& pose, double range_max_m = 12.0) {
  const world::Fan fan = RoundFan(range_max_m);
  return ReadScan({fan, 0.0, fan.beams}, Ranges(fan, walls, pose), {});
}

}  // namespace robotteamsim::maps
