"""Beams of sensors as rays of MuJoCo."""

from __future__ import annotations

import math
from typing import Protocol

import mujoco
import numpy as np

from robotteamsim.scenario.sensors import LightSensor
from robotteamsim.scenario.sensors.base import Fan
from robotteamsim.world.mujoco.shapes import BUILDING_GROUP, FLOOR_GROUP, OBJECT_GROUP, ROBOT_GROUP

_SEEN = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
_SEEN[[FLOOR_GROUP, BUILDING_GROUP, ROBOT_GROUP, OBJECT_GROUP]] = 1


class Bodies(Protocol):
    """The model and the state whose bodies return rays."""

    model: mujoco.MjModel
    data: mujoco.MjData

    def body_id(self, robot_id: int) -> int | None:
        """Return the index of a robot's body; None if it is absent."""


class Rays:
    """Casts rays at the floor, walls, doors, objects and other robots, in the current state; wheels return none."""

    def __init__(self, bodies: Bodies) -> None:
        self._bodies = bodies
        self._directions: dict[Fan, np.ndarray] = {}

    def ranges_m(self, robot_id: int, fan: Fan) -> np.ndarray:
        """Return how far each beam of a robot reaches, float64, shape (beams,) [m]; see `AnyWorld.caster`."""
        body = self._bodies.body_id(robot_id)
        if body is None:
            return np.full(fan.beams, np.inf)
        if fan not in self._directions:
            self._directions[fan] = _directions(fan)
        turn, origin = self._placed(body, (fan.forward_m, fan.left_m, fan.height_m))
        return self.cast_m(robot_id, origin, self._directions[fan] @ turn.T, fan.range_max_m)

    def axis(self, robot_id: int, sensor: LightSensor) -> tuple[np.ndarray, np.ndarray] | None:
        """Return place and direction of a robot's sensor in `map`, each of shape (3,); None for an absent robot."""
        body = self._bodies.body_id(robot_id)
        if body is None:
            return None
        turn, origin = self._placed(body, (sensor.forward_m, sensor.left_m, sensor.height_m))
        level, up = math.cos(sensor.pitch_rad), math.sin(sensor.pitch_rad)
        return origin, turn @ (level * math.cos(sensor.yaw_rad), level * math.sin(sensor.yaw_rad), up)

    def cast_m(self, robot_id: int, origin: np.ndarray, directions: np.ndarray, range_max_m: float) -> np.ndarray:
        """Return how far rays in `map` reach that the body of a present robot does not stop; inf without a return.

        Args: origin: shape (3,) [m].  directions: unit vectors, shape (rays, 3).
        """
        num_rays, data = len(directions), self._bodies.data
        hits, ranges_m = np.empty(num_rays, dtype=np.int32), np.empty(num_rays)
        mujoco.mj_multiRay(
            self._bodies.model,
            data,
            origin,
            directions.ravel(),
            _SEEN,
            1,
            self._bodies.body_id(robot_id),
            hits,
            ranges_m,
            None,
            num_rays,
            range_max_m,
        )
        ranges_m[hits < 0] = np.inf
        return ranges_m

    def _placed(self, body: int, mount: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the rotation of a body, shape (3, 3), and the place of what is mounted on it, in `map`."""
        turn = self._bodies.data.xmat[body].reshape(3, 3)
        return turn, self._bodies.data.xpos[body] + turn @ mount


def _directions(fan: Fan) -> np.ndarray:
    """Return the beams as unit vectors in base_link, float64, shape (beams, 3)."""
    angles_rad = np.linspace(fan.angle_min_rad, fan.angle_max_rad, fan.beams)
    return np.column_stack((np.cos(angles_rad), np.sin(angles_rad), np.zeros(fan.beams)))
