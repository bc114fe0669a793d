"""The attractors x_OB (obstacles) and x_CB (communication) of eq. (22)."""

import math

import numpy as np

from robotteamsim import _core
from robotteamsim.swarm.velocity import Vector


def obstacle_attractor(position: Vector, hits_m: np.ndarray, candidates_m: np.ndarray) -> Vector:
    """Return x_OB: among the candidates and the robot's position, the point farthest from the laser hits.

    It is the robot's position if there are no hits or no candidate is better; ties go to the first candidate. A best
    from the past would be wrong for a moving robot.

    Args: hits_m: float64, shape (k, 2).  candidates_m: float64, shape (m, 2): points that the laser sees as free.
    """
    if len(hits_m) == 0 or len(candidates_m) == 0:
        return position
    best = _core.swarm.farthest_from(hits_m, position, candidates_m)
    if best < 0:
        return position
    x_m, y_m = candidates_m[best].tolist()
    return x_m, y_m


def communication_attractor(position: Vector, neighbour: Vector, range_m: float) -> Vector:
    """Return x_CB: the point at `range_m` from the neighbour, in the direction of the robot [5.2.2].

    It attracts a robot that is farther away back to that distance, and pushes a nearer one out to it. A robot at the
    position of its neighbour stays there.
    """
    away_x, away_y = position[0] - neighbour[0], position[1] - neighbour[1]
    distance_m = math.hypot(away_x, away_y)
    if distance_m == 0.0:
        return position
    return neighbour[0] + away_x / distance_m * range_m, neighbour[1] + away_y / distance_m * range_m


def communication_weight(c4: float, proximity: float, endangered_proximity: float, connected: bool) -> float:
    """Return the weight of the communication term: 0 while the link is safe, c4 if it is lost.

    In between it grows as the proximity P_n falls from that of an endangered link to 0. x_CB pushes robots apart
    wherever a link is good; without this weight, missions fail.

    Args: proximity: P_n of eq. (31) or (32).  endangered_proximity: P_n at the threshold, in (0, 1].
          connected: whether the swarm connectivity C_s of eq. (34) is above 0.
    """
    if not connected:
        return c4
    return c4 * max(0.0, 1.0 - proximity / endangered_proximity)
