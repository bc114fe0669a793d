#pragma once

#include <cstdint>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::world {

/// The last step of a team in any world; one entry per robot.
struct TeamMotion {
  std::vector<base::Pose> poses;         ///< in `map`; NaN for an absent robot
  std::vector<base::Twist> twists;       ///< mean velocities, in base_link
  std::vector<base::Pose> motions;       ///< in the frame of the step's beginning
  std::vector<std::uint8_t> in_contact;  ///< whether it touched something: 0 or 1
};

}  // namespace robotteamsim::world
