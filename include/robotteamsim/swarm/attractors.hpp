#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::swarm {

/// Returns the index of the candidate with the greatest distance from the nearest point, the first of equals; -1 if
/// none is farther than `place`.
int FarthestFrom(const std::vector<base::Point>& points, const base::Point& place,
                 const std::vector<base::Point>& candidates);

}  // namespace robotteamsim::swarm
