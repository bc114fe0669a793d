#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::hazards {

/// Smoke as an obstacle for light.
class Haze {
 public:
  /// Args: soot: per cell [g/m^3].  extinction: of light by it [m^2/g].  limit: light does not come through a larger
  /// optical depth.  Throws std::invalid_argument: a size or a number is wrong.
  Haze(const plan::GridShape& shape, std::vector<float> soot, double extinction, double limit);

  /// Returns whether no straight line of this length [m] from a point can reach the limit.
  bool IsClearAround(const base::Point& point, double length) const;

  /// Returns how far one sees from a point in a direction, a unit vector; at most `length` [m]. From a point beyond the
  /// cells nothing is hidden.
  double Sight(const base::Point& point, const base::Point& direction, double length) const;

 private:
  plan::GridShape shape_;
  std::vector<float> soot_;
  double extinction_;
  float densest_ = 0.0F;
  double limit_;
};

}  // namespace robotteamsim::hazards
