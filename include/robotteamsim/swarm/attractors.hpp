#pragma once

#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::swarm {

/// Returns the index of the candidate that is farther from all points than `place` and than the candidates before it;
/// -1 where none is farther than `place`.
int FarthestFrom(const std::vector<base::Point>& points, const base::Point& place,
                 const std::vector<base::Point>& candidates);

}  // namespace robotteamsim::swarm
