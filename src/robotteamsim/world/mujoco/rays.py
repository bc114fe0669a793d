"""Beams of sensors as rays of MuJoCo."""

from __future__ import annotations

from typing import Protocol

import mujoco
import numpy as np

from robotteamsim.world.contract import Fan
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

    def ranges_m(self, robot_id: int, fan: Fan) -> np.ndarray:
        """See `contract.Scene`."""
        body, num_rays = self._bodies.body_id(robot_id), len(fan.angles_rad)
        if body is None:
            return np.full(num_rays, np.inf)
        data = self._bodies.data
        turn = data.xmat[body].reshape(3, 3)
        origin = data.xpos[body] + turn @ (fan.forward_m, fan.left_m, fan.height_m)
        directions = fan.directions @ turn.T
        hits, ranges_m = np.empty(num_rays, dtype=np.int32), np.empty(num_rays)
        mujoco.mj_multiRay(
            self._bodies.model,
            data,
            origin,
            directions.ravel(),
            _SEEN,
            1,
            body,
            hits,
            ranges_m,
            None,
            num_rays,
            fan.range_max_m,
        )
        ranges_m[hits < 0] = np.inf
        return ranges_m
