#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::hazards {

/// Smoke as an obstacle for light.
class Haze {
 public:
  /// Args: soot_g_m3: per cell.  extinction_m2_g: of light by it.  limit: light does not come through a larger
  /// optical depth.  Throws std::invalid_argument: a size or a number is wrong.
  Haze(const plan::GridShape& shape, std::vector<float> soot_g_m3, double extinction_m2_g, double limit);

  /// Returns whether no straight line of this length [m] from a point can reach the limit.
  bool IsClearAround(const base::Point& point, double length_m) const;

  /// Returns how far one sees from a point in a direction, a unit vector; at most `length_m`. From a point beyond the
  /// cells nothing is hidden.
  double Sight(const base::Point& point, const base::Point& direction, double length_m) const;

 private:
  plan::GridShape shape_;
  std::vector<float> soot_g_m3_;
  double extinction_m2_g_;
  float densest_g_m3_ = 0.0F;
  double limit_;
};

}  // namespace robotteamsim::hazards
