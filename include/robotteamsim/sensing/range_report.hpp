#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"
#include "robotteamsim/base/table.hpp"
#include "robotteamsim/hazards/haze.hpp"
#include "robotteamsim/world/fan_caster.hpp"

namespace robotteamsim::sensing {

/// The ranges that a sensor measures, and what it reports instead of all others.
struct RangeLimits {
  double range_min_m = 0.0;
  double range_max_m = 5.0;
  double too_near_m = 0.0;   ///< reported for a range below range_min_m, and for a NaN: the robot stops
  double no_return_m = 5.0;  ///< reported for a range above range_max_m
};

/// Writes true ranges as a sensor reports them [m]; all tables have one row per robot and one column per beam.
/// Args: noise_m: added to the ranges [m]; empty: none.
/// Throws std::invalid_argument if the shapes differ, the limits are not positive, ascending and within base::kLargest,
/// or a value to report is neither within it nor infinite.
void Report(const RangeLimits& limits, const base::Table<const double>& ranges_m,
            const base::Table<const double>& noise_m, const base::Table<float>& reported_m);

/// Removes the returns that smoke hides.
/// Args: robots: poses of the robots that carry the fan; NaN for absent ones.
///       no_return_m: replaces what is hidden.
///       reported_m: as Report writes them, one row per robot.
/// Throws std::invalid_argument if they have another shape, or no_return_m is neither within base::kLargest nor
/// infinite.
void Dim(const world::Fan& fan, const std::vector<base::Pose>& robots, const hazards::Haze& haze, double no_return_m,
         const base::Table<float>& reported_m);

}  // namespace robotteamsim::sensing
