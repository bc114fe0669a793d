"""Where the teammates of a robot are, as they say: beams that end there are no walls."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.scenario.base import Point
from robotteamsim.setup import Setup

Disc = tuple[Point, float]
"""Centre in `map` and radius [m]."""

_WRONG_BY_M = 0.3
"""The believed positions of two robots are wrong by so much together [m]."""

_OLDEST_NS = 3_000_000_000
"""News that are older do not help: the robot may be anywhere."""


class Teammates:
    """The last position of each teammate, and how far it may have driven since."""

    def __init__(self, robot_id: int, setup: Setup) -> None:
        self._robot_id = robot_id
        self._bodies = [(robot.reach_m, robot.drive.max_speed_mps) for robot in setup.robots]
        self._last: dict[int, tuple[int, Point]] = {
            i: (0, robot.start_pose[:2])
            for i, robot in enumerate(setup.robots)
            if i != robot_id and setup.knows_start(i)
        }

    def note(self, robot_id: int, position: Point, sim_time_ns: int) -> None:
        """Note where a teammate says that it is."""
        if robot_id != self._robot_id:
            self._last[robot_id] = sim_time_ns, position

    def discs(self, sim_time_ns: int) -> Sequence[Disc]:
        """Return where teammates may be now."""
        found = []
        for robot_id, (since_ns, position) in self._last.items():
            (reach_m, speed_mps), age_ns = self._bodies[robot_id], sim_time_ns - since_ns
            if age_ns <= _OLDEST_NS:
                radius_m = reach_m + speed_mps * 1e-9 * age_ns + _WRONG_BY_M
                found.append((position, radius_m))
        return found
