"""The context metrics of RDPSO [dissertation, eq. 28 to 32, and 34]."""

import math

import numpy as np
from numpy.typing import ArrayLike


def swarm_activity(velocities: ArrayLike, max_speed: float) -> float:
    """Return A_s of eq. (28): speed of the swarm's centre of mass over the maximum step; 0 at rest, 1 in full motion.

    Args:   velocities: shape (robots, dimensions) [same unit as max_speed].
    Raises: ValueError: no robots, or max_speed is not above 0.
    """
    v = np.asarray(velocities, dtype=np.float64)
    if len(v) == 0:
        raise ValueError("the activity of a swarm without robots is not defined")
    if not max_speed > 0.0:
        raise ValueError(f"max_speed must be > 0, got {max_speed}")
    return math.hypot(*np.mean(v, axis=0).tolist()) / max_speed


def robot_socialisation(position: ArrayLike, global_best: ArrayLike, positions: ArrayLike) -> float | np.ndarray:
    """Return S_n of eq. (29): 1 at the global best, 0 for the robot farthest from it.

    If all robots are at the global best, 0/0 counts as 1.

    Args:    position: of one robot, shape (dimensions,), or of several, shape (n, dimensions).
             positions: of the whole swarm, shape (robots, dimensions).
    Returns: a number, or float64, shape (n,).
    """
    away_m = _distances(position, global_best)
    farthest_m = np.max(_distances(positions, global_best))
    if farthest_m == 0.0:
        return np.ones_like(away_m)[()]
    quality: float | np.ndarray = (1.0 - away_m / farthest_m)[()]
    return quality


def _distances(places: ArrayLike, place: ArrayLike) -> np.ndarray:
    """Return the distances of places, shape (..., dimensions), from one, shape (dimensions,)."""
    offsets = np.asarray(places, dtype=np.float64) - np.asarray(place, dtype=np.float64)
    return np.asarray(np.sqrt(np.sum(offsets * offsets, axis=-1)))


def robot_avoidance(clearance_m: float, sensing_radius_m: float) -> float:
    """Return O_n of eq. (30): 0 if nothing is within the sensing radius r_s, towards 1 at an obstacle.

    Raises: ValueError: the sensing radius is not above 0.
    """
    if not sensing_radius_m > 0.0:
        raise ValueError(f"sensing_radius_m must be > 0, got {sensing_radius_m}")
    return (sensing_radius_m - min(clearance_m, sensing_radius_m)) / sensing_radius_m


def robot_proximity_by_distance(distance_m: float, max_distance_m: float) -> float:
    """Return P_n of eq. (31) for the nearest neighbour: 1 at its position, 0 at d_max and beyond."""
    return max(0.0, 1.0 - distance_m / max_distance_m)


def robot_proximity_by_signal(signal_dbm: float, min_signal_dbm: float, signal_at_1_m_dbm: float) -> float:
    """Return P_n for the signal of the nearest neighbour: 1 at the signal at 1 m and above, 0 at q_min and below.

    Eq. (32) as printed is negative for signals in dBm; this is (q - q_min) / (q_1m - q_min) within [0, 1].

    Raises: ValueError: q_1m is not above q_min.
    """
    if not signal_at_1_m_dbm > min_signal_dbm:
        raise ValueError(f"the signal at 1 m, {signal_at_1_m_dbm} dBm, must be above the minimum, {min_signal_dbm} dBm")
    proximity = (signal_dbm - min_signal_dbm) / (signal_at_1_m_dbm - min_signal_dbm)
    return min(1.0, max(0.0, proximity))


def swarm_connectivity(fiedler_value: float, num_robots: int) -> float:
    """Return C_s of eq. (34): lambda_2 / N_s; 1 if all links exist, 0 if the swarm is split.

    A single robot is connected. Raises: ValueError: no robots.
    """
    if num_robots < 1:
        raise ValueError(f"the connectivity of a swarm of {num_robots} robots is not defined")
    if num_robots == 1:
        return 1.0
    return max(0.0, fiedler_value) / num_robots
