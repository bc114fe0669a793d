"""Where the bodies of a compiled model are in its arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from robotteamsim.geometry import Pose
from robotteamsim.world.mujoco.shapes import FLOOR_GROUP, ROBOT_GROUP, about_z

_GROUND_NORMAL = 0.5
"""Least upward part of the normal of a contact with the ground."""


@dataclass(frozen=True)
class SavedBody:
    """Positions and velocities of all joints of a body and of those that it carries."""

    qpos: np.ndarray
    qvel: np.ndarray


class FreeBodies:
    """The bodies of a model that move freely, robots with their wheels and then objects, in the order of the model."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]) -> None:
        self.data = data
        self.ids = np.array([model.body(name).id for name in names], dtype=int)
        joints = model.body_jntadr[self.ids]
        self._qpos, self._qvel = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._at_rest = model.qpos0
        self._pose_at = self._qpos[:, None] + np.arange(7)
        self._velocity_at = self._qvel[:, None] + (0, 1, 5)
        # The joints of each body and its wheels end where those of the next begin.
        self._qpos_of = list(map(slice, self._qpos.tolist(), [*self._qpos[1:].tolist(), model.nq]))
        self._qvel_of = list(map(slice, self._qvel.tolist(), [*self._qvel[1:].tolist(), model.nv]))

    def poses(self) -> np.ndarray:
        """Return the poses on the floor, float64, shape (bodies, 3): x, y [m] and the heading [rad]."""
        qpos, (cos, sin) = self.data.qpos[self._pose_at], self._heading()
        return np.column_stack((qpos[:, 0], qpos[:, 1], np.arctan2(sin, cos)))

    def lean_rad(self) -> np.ndarray:
        """Return the angle between each body's axis and the vertical."""
        qpos = self.data.qpos[self._pose_at]
        lean_rad: np.ndarray = 2.0 * np.arcsin(np.minimum(np.hypot(qpos[:, 4], qpos[:, 5]), 1.0))
        return lean_rad

    def speeds(self) -> np.ndarray:
        """Return the current speeds in the heading's frame, float64, shape (bodies, 3): forward, turn, left."""
        qvel, (cos, sin) = self.data.qvel[self._velocity_at], self._heading()
        vx, vy = qvel[:, 0] / np.hypot(cos, sin), qvel[:, 1] / np.hypot(cos, sin)
        return np.column_stack((cos * vx + sin * vy, qvel[:, 2], cos * vy - sin * vx))

    def _heading(self) -> tuple[np.ndarray, np.ndarray]:
        """Return cosine and sine of each body's heading; smaller by the same factor for a body that leans forward."""
        w, x, y, z = self.data.qpos[self._pose_at][:, 3:].T
        return 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)

    def place(self, index: int, pose: Pose, ground_m: float) -> None:
        """Put a body upright on the ground, at rest."""
        qpos, qvel, begin = self._qpos_of[index], self._qvel_of[index], int(self._qpos[index])
        self.data.qpos[qpos] = self._at_rest[qpos]
        self.data.qpos[begin : begin + 7] = [pose.x_m, pose.y_m, ground_m, *about_z(pose.yaw_rad)]
        self.data.qvel[qvel] = 0.0
        self.data.qacc_warmstart[qvel] = 0.0

    def saved(self, index: int) -> SavedBody:
        """Return the state of a body."""
        return SavedBody(self.data.qpos[self._qpos_of[index]].copy(), self.data.qvel[self._qvel_of[index]].copy())

    def restore(self, index: int, saved: SavedBody) -> None:
        """Set the state of a body."""
        self.data.qpos[self._qpos_of[index]] = saved.qpos
        self.data.qvel[self._qvel_of[index]] = saved.qvel


class Touches:
    """Which robots touch something that is not the ground; the side of a ramp counts as a wall."""

    def __init__(self, model: mujoco.MjModel, bodies: FreeBodies) -> None:
        self._index_of = np.full(model.ngeom, -1)
        for index, body in enumerate(bodies.ids.tolist()):
            self._index_of[(model.geom_bodyid == body) & (model.geom_group == ROBOT_GROUP)] = index
        self._is_floor = model.geom_group == FLOOR_GROUP

    def found(self, data: mujoco.MjData) -> list[tuple[int, np.ndarray]]:
        """Return the current touches: the index of each robot, and the place in `map` [m]."""
        if data.ncon == 0:
            return []
        geoms = data.contact.geom
        robots = self._index_of[geoms]
        is_steep = np.abs(data.contact.frame[:, 2]) < _GROUND_NORMAL  # row 0 of the frame is the normal
        is_touch = (robots >= 0) & (~self._is_floor[geoms[:, ::-1]] | is_steep[:, None])
        if not is_touch.any():
            return []
        places = data.contact.pos
        rows, sides = np.nonzero(is_touch)
        return [(int(robots[row, side]), places[row, :2].copy()) for row, side in zip(rows, sides, strict=True)]
