"""How a swarm and its robots do: the context metrics of RDPSO [dissertation, eq. 28 to 32]."""

from __future__ import annotations

import math
from collections.abc import Sequence

from robotteamsim.swarm.velocity import Vector


def swarm_activity(velocities: Sequence[Vector], max_speed: float) -> float:
    """Return A_s of eq. (28): speed of the swarm's centre of mass over the maximum step; 0 at rest, 1 in full motion.

    Raises: ValueError: no robot, or a maximum step that is not above 0.
    """
    if not velocities:
        raise ValueError("the activity of a swarm without robots is not defined")
    if not max_speed > 0.0:
        raise ValueError(f"max_speed must be > 0, got {max_speed}")
    mean_x = sum(x for x, _ in velocities) / len(velocities)
    mean_y = sum(y for _, y in velocities) / len(velocities)
    return math.hypot(mean_x, mean_y) / max_speed


def robot_socialisation(position: Vector, global_best: Vector, positions: Sequence[Vector]) -> float:
    """Return S_n of eq. (29): 1 at the global best, 0 for the robot farthest from it.

    Where all robots are at the global best, 0/0 counts as 1.
    """
    farthest_m = max(math.dist(global_best, other) for other in positions)
    if farthest_m == 0.0:
        return 1.0
    return 1.0 - math.dist(global_best, position) / farthest_m


def robot_avoidance(clearance_m: float, sensing_radius_m: float) -> float:
    """Return O_n of eq. (30): 0 with nothing within the sensing radius r_s, towards 1 at an obstacle.

    Raises: ValueError: a sensing radius that is not above 0.
    """
    if not sensing_radius_m > 0.0:
        raise ValueError(f"sensing_radius_m must be > 0, got {sensing_radius_m}")
    return (sensing_radius_m - min(clearance_m, sensing_radius_m)) / sensing_radius_m


def robot_proximity_by_distance(distance_m: float, max_distance_m: float) -> float:
    """Return P_n of eq. (31) for the nearest neighbour: 1 beside it, 0 at d_max and beyond."""
    return max(0.0, 1.0 - distance_m / max_distance_m)


def robot_proximity_by_signal(signal_dbm: float, min_signal_dbm: float, signal_at_1_m_dbm: float) -> float:
    """Return P_n for the signal of the nearest neighbour: 1 at what 1 m gives and above, 0 at q_min and below.

    Eq. (32) as printed is negative for signals in dBm; this is (q - q_min) / (q_1m - q_min) within [0, 1].

    Raises: ValueError: q_1m is not above q_min.
    """
    if not signal_at_1_m_dbm > min_signal_dbm:
        raise ValueError(f"the signal at 1 m, {signal_at_1_m_dbm} dBm, must be above the minimum, {min_signal_dbm} dBm")
    proximity = (signal_dbm - min_signal_dbm) / (signal_at_1_m_dbm - min_signal_dbm)
    return min(1.0, max(0.0, proximity))
