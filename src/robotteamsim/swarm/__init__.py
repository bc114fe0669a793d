"""The particle swarm family, PSO, DPSO, RPSO and RDPSO, as pure functions for robots.

Equation numbers are those of the dissertation.
"""

from robotteamsim.swarm.context import (
    EXACT_LEVELS,
    PUBLISHED_LEVELS,
    Context,
    Levels,
    adapted_coefficients,
    robot_avoidance,
    robot_proximity_by_distance,
    robot_proximity_by_signal,
    robot_socialisation,
    swarm_activity,
    swarm_connectivity,
)
from robotteamsim.swarm.exclusion import (
    ExclusionRules,
    SwarmState,
    Verdict,
    judge,
    natural_selection,
    punished_search_counter,
    spawn_chance,
)
from robotteamsim.swarm.velocity import (
    Attractors,
    MemoryMode,
    Vector,
    Weights,
    communication_attractor,
    communication_weight,
    limit_speed,
    memory_coefficients,
    memory_term,
    next_position,
    next_velocity,
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
    "punished_search_counter",
    "robot_avoidance",
    "robot_proximity_by_distance",
    "robot_proximity_by_signal",
    "robot_socialisation",
    "spawn_chance",
    "swarm_activity",
    "swarm_connectivity",
]
