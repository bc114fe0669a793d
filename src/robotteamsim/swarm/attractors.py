"""Where obstacles and the network draw a robot: x_OB and x_CB of eq. (22)."""

import math

import numpy as np

from robotteamsim import _core
from robotteamsim.swarm.velocity import Vector


def obstacle_attractor(position: Vector, hits_m: np.ndarray, candidates_m: np.ndarray) -> Vector:
    """Return x_OB: of the candidates and the robot's position, the point farthest from what the laser hit.

    The robot's position is taken where nothing was hit, and where no candidate is better; of equal candidates the
    first. A best of the past would be wrong on a moving robot.

    Args: hits_m: float64, shape (k, 2).  candidates_m: float64, shape (m, 2): points that the laser sees to be free.
    """
    if len(hits_m) == 0 or len(candidates_m) == 0:
        return position
    best = _core.swarm.farthest_from(hits_m, position, candidates_m)
    if best < 0:
        return position
    x_m, y_m = candidates_m[best].tolist()
    return x_m, y_m


def communication_attractor(position: Vector, neighbour: Vector, range_m: float) -> Vector:
    """Return x_CB: the neighbour's position and `range_m` from there towards the robot [5.2.2].

    It draws a robot that is farther than `range_m` back to that distance, and drives a nearer one away to it. A robot
    that stands on its neighbour stays.
    """
    away_x, away_y = position[0] - neighbour[0], position[1] - neighbour[1]
    distance_m = math.hypot(away_x, away_y)
    if distance_m == 0.0:
        return position
    return neighbour[0] + away_x / distance_m * range_m, neighbour[1] + away_y / distance_m * range_m


def communication_weight(c4: float, proximity: float, endangered_proximity: float, connected: bool) -> float:
    """Return the weight of the communication term: 0 while the link is safe, c4 when it is lost.

    In between it grows as the proximity P_n falls from that of an endangered link to 0. x_CB drives robots apart
    wherever a link is good; ungated, that destroys the mission.

    Args: proximity: P_n of eq. (31) or (32).  endangered_proximity: P_n at the threshold, in (0, 1].
          connected: whether the swarm connectivity C_s of eq. (34) is above 0.
    """
    if not connected:
        return c4
    return c4 * max(0.0, 1.0 - proximity / endangered_proximity)
