#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/plan/grid.hpp"

namespace robotteamsim::hazards {

/// A view of values of the cells of a grid, such as their temperatures, row by row.
struct GridValues {
  plan::GridShape shape;
  const float* data = nullptr;
};

/// Returns the values of the cells that contain some points; `outside` for a point beyond the grid, also for NaN.
/// Throws std::invalid_argument if the shape cannot be used, or a value or `outside` is not finite.
std::vector<double> ValuesAt(const GridValues& values, const std::vector<base::Point>& points, double outside);

/// Returns the centres of the cells that are at least as hot as `limit_c` and within `range_m` of a place, and to which
/// the straight line is free in `sight`; row by row.
/// Throws std::invalid_argument if the shape, the place or the range cannot be used.
std::vector<base::Point> HotInSight(const GridValues& temperatures, double limit_c, const plan::PlanningGrid& sight,
                                    const base::Point& place, double range_m);

}  // namespace robotteamsim::hazards
