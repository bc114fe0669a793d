// _core.swarm: velocities of a robotic swarm.
#include <array>
#include <cstddef>

#include "bindings.hpp"
#include "casters.hpp"
#include "robotteamsim/swarm/velocity.hpp"

namespace robotteamsim::bindings {
namespace {

// v[t+1] for the four attractors of eq. (22), their weights, and one random number in [0, 1) for each.
base::Point VelocityOf(const base::Point& position, const base::Point& inertia,
                       const std::array<base::Point, 4>& attractors, const std::array<double, 4>& weights,
                       const std::array<double, 4>& numbers) {
  std::array<swarm::Pull, 4> pulls;
  for (std::size_t i = 0; i < pulls.size(); ++i) pulls[i] = {weights[i], numbers[i], attractors[i]};
  return swarm::NextVelocity(position, inertia, pulls);
}

}  // namespace

void BindSwarm(nb::module_&& m) {
  m.def("next_velocity", &VelocityOf, "position"_a, "inertia"_a, "attractors"_a, "weights"_a, "numbers"_a);
  m.def("memory_term", &swarm::MemoryTerm, "coefficients"_a, "velocities"_a);
}

}  // namespace robotteamsim::bindings
