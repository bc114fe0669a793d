"""The particle swarm family, PSO, DPSO, RPSO and RDPSO, as pure functions for robots.

Equation numbers are those of the dissertation.
"""

from robotteamsim.swarm.adaptation import EXACT_LEVELS, PUBLISHED_LEVELS, Context, Levels, adapted_coefficients
from robotteamsim.swarm.attractors import communication_attractor, communication_weight, obstacle_attractor
from robotteamsim.swarm.exclusion import (
    ExclusionRules,
    SwarmState,
    Verdict,
    judge,
    natural_selection,
    punished_search_counter,
    spawn_chance,
)
from robotteamsim.swarm.memory import MemoryMode, memory_coefficients, memory_term
from robotteamsim.swarm.metrics import (
    robot_avoidance,
    robot_proximity_by_distance,
    robot_proximity_by_signal,
    robot_socialisation,
    swarm_activity,
    swarm_connectivity,
)
from robotteamsim.swarm.velocity import (
    Attractors,
    Vector,
    Weights,
    limit_speed,
    next_position,
    next_velocity,
    uniform_numbers,
)

__all__ = [
    "EXACT_LEVELS",
    "PUBLISHED_LEVELS",
    "Attractors",
    "Context",
    "ExclusionRules",
    "Levels",
    "MemoryMode",
    "SwarmState",
    "Vector",
    "Verdict",
    "Weights",
    "adapted_coefficients",
    "communication_attractor",
    "communication_weight",
    "judge",
    "limit_speed",
    "memory_coefficients",
    "memory_term",
    "natural_selection",
    "next_position",
    "next_velocity",
    "obstacle_attractor",
    "punished_search_counter",
    "robot_avoidance",
    "robot_proximity_by_distance",
    "robot_proximity_by_signal",
    "robot_socialisation",
    "spawn_chance",
    "swarm_activity",
    "swarm_connectivity",
    "uniform_numbers",
]
