#pragma once

#include <array>

#include "robotteamsim/plan/types.hpp"

namespace robotteamsim {

/// One component of eq. (22): its weight c, its random number r in [0, 1), and the attractor x.
struct Pull {
  double weight;
  double random;
  Point attractor;
};

/// v[t+1] = inertia + sum of c * r * (attractor - x[t]), in the order given [dissertation, eq. 22 and 25].
inline Point NextVelocity(const Point& position, const Point& inertia, const std::array<Pull, 4>& pulls) {
  Point velocity = inertia;
  for (const Pull& pull : pulls) {
    velocity.x += pull.weight * pull.random * (pull.attractor.x - position.x);
    velocity.y += pull.weight * pull.random * (pull.attractor.y - position.y);
  }
  return velocity;
}

}  // namespace robotteamsim
