#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "robotteamsim/base/geometry.hpp"

namespace robotteamsim::swarm {

/// Returns a velocity. Throws std::invalid_argument if it is not finite.
inline base::Point Finite(const base::Point& velocity) {
  if (std::isfinite(velocity.x) && std::isfinite(velocity.y)) return velocity;
  throw std::invalid_argument(
      "positions, velocities and weights of a swarm must be finite, and so small that their sum is");
}

/// One component of eq. (22): its weight c, its random number r in [0, 1), and the attractor x.
struct Pull {
  double weight;
  double random;
  base::Point attractor;
};

/// v[t+1] = inertia + sum of c * r * (attractor - x[t]), in the order given [dissertation, eq. 22 and 25].
inline base::Point NextVelocity(const base::Point& position, const base::Point& inertia,
                                const std::array<Pull, 4>& pulls) {
  base::Point velocity = inertia;
  for (const Pull& pull : pulls) {
    velocity.x += pull.weight * pull.random * (pull.attractor.x - position.x);
    velocity.y += pull.weight * pull.random * (pull.attractor.y - position.y);
  }
  return Finite(velocity);
}

/// The memory term of eq. (25): the sum of past velocities, newest first, times their weights; missing velocities count
/// as zero.
inline base::Point MemoryTerm(const std::vector<double>& coefficients, const std::vector<base::Point>& velocities) {
  base::Point sum{0.0, 0.0};
  for (std::size_t i = 0; i < std::min(coefficients.size(), velocities.size()); ++i) {
    sum.x += coefficients[i] * velocities[i].x;
    sum.y += coefficients[i] * velocities[i].y;
  }
  return Finite(sum);
}

}  // namespace robotteamsim::swarm
