"""Robotic Darwinian particle swarm optimisation (RDPSO): pure functions, usable on any objective.

Equation numbers are those of the dissertation.
"""

from robotteamsim.swarm.attractors import communication_attractor, communication_weight, obstacle_attractor
from robotteamsim.swarm.exclusion import ExclusionRules, SwarmState, Verdict, judge, punished_search_counter
from robotteamsim.swarm.memory import MemoryMode, memory_coefficients, memory_term
from robotteamsim.swarm.metrics import (
    robot_avoidance,
    robot_proximity_by_distance,
    robot_proximity_by_signal,
    robot_socialisation,
    swarm_activity,
)
from robotteamsim.swarm.velocity import Attractors, Vector, Weights, limit_speed, next_position, next_velocity

__all__ = [
    "Attractors",
    "ExclusionRules",
    "MemoryMode",
    "SwarmState",
    "Vector",
    "Verdict",
    "Weights",
    "communication_attractor",
    "communication_weight",
    "judge",
    "limit_speed",
    "memory_coefficients",
    "memory_term",
    "next_position",
    "next_velocity",
    "obstacle_attractor",
    "punished_search_counter",
    "robot_avoidance",
    "robot_proximity_by_distance",
    "robot_proximity_by_signal",
    "robot_socialisation",
    "swarm_activity",
]
