"""An example: a particle swarm, by the equations of the robots, finds the minimum of a function of two variables."""

import numpy as np

from robotteamsim.swarm import (
    Attractors,
    Weights,
    limit_speed,
    memory_coefficients,
    memory_term,
    next_position,
    next_velocity,
)

PARTICLES, ITERATIONS, MAX_STEP = 40, 200, 2.0
MEMORY = memory_coefficients("grunwald_letnikov", 0.6, 4)
WEIGHTS = Weights(cognitive=1.0, social=1.0, obstacle=0.0, communication=0.0)


def rastrigin(x: float, y: float) -> float:
    """Return a value that is 0 at the origin, among many local minima."""
    return 20.0 + sum(u * u - 10.0 * np.cos(2.0 * np.pi * u) for u in (x, y))


generator = np.random.default_rng(1)
dice = np.random.default_rng(2)
positions = [tuple(point) for point in generator.uniform(-5.0, 4.0, (PARTICLES, 2)).tolist()]
velocities = [[] for _ in positions]
bests = list(positions)
for _ in range(ITERATIONS):
    global_best = min(bests, key=lambda point: rastrigin(*point))
    for i, here in enumerate(positions):
        attractors = Attractors(bests[i], global_best, here, here)
        numbers = dice.random(4).tolist()
        velocity = next_velocity(here, memory_term(MEMORY, velocities[i]), attractors, WEIGHTS, numbers)
        velocities[i] = [limit_speed(velocity, MAX_STEP), *velocities[i]][: len(MEMORY)]
        positions[i] = next_position(here, velocities[i][0])
        bests[i] = min(bests[i], positions[i], key=lambda point: rastrigin(*point))
best = min(bests, key=lambda point: rastrigin(*point))
print(f"{rastrigin(*best):.3f} at ({best[0]:.3f}, {best[1]:.3f})")
