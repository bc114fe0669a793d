"""The world of MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.geometry import Twist
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import Run
from robotteamsim.world.base_world import BaseWorld
from robotteamsim.world.contract import Mishap
from robotteamsim.world.mujoco.cameras import Scene
from robotteamsim.world.mujoco.engine import Engine


class MujocoWorld(BaseWorld):
    """A floor plan with heights, robots on wheels, and objects, in three dimensions.

    Motors turn the wheels at the speeds that the drive wants; friction of the tyres on the floor moves the robot.
    Wheels slip and robots lean, so a robot does not move exactly as its drive computes, and it may tip over. A robot
    that has left the bounds of the plan is removed.

    `AnyWorld` documents the members.
    """

    engine: Engine
    """Model and state of MuJoCo."""

    @property
    def scene(self) -> Scene:
        """What sensors measure."""
        return self._scene

    def _make_physics(self, run: Run) -> Engine:
        self.engine = Engine(self.plan, self._robots, run, self._objects)
        self._scene = Scene(self.engine)
        self._tipped_rad = run.mujoco.tipped_rad
        self._reaches_m = np.array([robot.reach_m for robot in self._robots])
        return self.engine

    def _advance(self, twists: Sequence[Twist] | np.ndarray) -> None:
        self.engine.step(twists)
        self._note_mishaps()

    def _add_body(self, obj: MovableObject) -> None:
        self.engine.add_object(obj)

    def _note_mishaps(self) -> None:
        tipped = self.engine.lean_rad() > self._tipped_rad  # not for NaN
        mishaps: dict[int, Mishap] = dict.fromkeys(np.flatnonzero(tipped).tolist(), "tipped_over")
        for robot_id in np.flatnonzero(self._has_left()).tolist():
            self.remove_robot(robot_id)
            mishaps[robot_id] = "left_world"
        left = {i: why for i, why in self.mishaps.items() if why == "left_world" and not self._is_present(i)}
        mishaps = dict(sorted((left | mishaps).items()))
        if mishaps != self.mishaps:
            self.mishaps = mishaps

    def _has_left(self) -> np.ndarray:
        """Return whether each robot is completely beyond the bounds of the plan."""
        positions_m, bounds = self.positions_m(), self.plan.bounds
        beyond = np.maximum(np.array(bounds.min) - positions_m, positions_m - np.array(bounds.max)).max(axis=1)
        has_left: np.ndarray = beyond > self._reaches_m  # not for NaN
        return has_left
