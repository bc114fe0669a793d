"""What agents remember of a building that nobody knows: the map that each has found, and where it ends."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.exploration.choice import Choice
from robotteamsim.learning.observe import Memory, Percepts, cos_sin, seen_from
from robotteamsim.maps.found_map import CELL_M
from robotteamsim.maps.own_map import cells_at
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.controllers.frontier import FrontierControl
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

SIDE = 15
"""Squares along each side of the part of the map that an agent perceives, with itself in the middle one."""

SQUARE_M = 1.0
"""Their edge [m]."""

_POINTS = round(SQUARE_M / CELL_M)
"""Along each side of a square, at which the map is looked at: found walls may be one cell thick."""

_AHEAD_M = 0.5
"""The direction of a path is that to its point at this distance [m]."""


class FoundMemory(Memory):
    """The map that each agent has found, and the path to the nearest frontier in it.

    What an agent knows is what its `Survey` knows, as that of any controller: its own map, and what teammates have sent
    over the network of theirs, in messages that may be lost and that the mission counts. They are sent and read without
    the policy. Not shared are paths and frontiers; the policy may say so by its own numbers (`said`).

    The nearest frontier is that of the controller `frontier` with `choice: nearest` and its defaults, but agents do not
    coordinate. It is chosen again when it is no longer one, and after `replan_s`.
    """

    def __init__(self, setup: Setup, robot_ids: Sequence[int]) -> None:
        """See `Memory`."""
        super().__init__(setup, robot_ids)
        bounds, tuning = setup.plan.bounds, FrontierControl(algorithm="frontier", choice="nearest")
        self._diagonal_m = math.dist(bounds.min, bounds.max)
        self._agents = [_Explorer(setup, i, tuning) for i in robot_ids]

    @classmethod
    def parts_of(cls, setup: Setup) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part of the numbers."""
        squares = f"{SIDE} x {SIDE} squares of {SQUARE_M:g} m around the robot, from its right to its left, each row"
        found = "from behind it to ahead: 1 with a wall, else 0 (unknown) to -1 (all free)"
        there = "there is a frontier; ahead and left of the direction of the path there, its length / diagonal"
        return [
            ("found", SIDE * SIDE, f"{squares} {found}"),
            ("frontier", 5, f"share of the cells within the bounds that are known; {there}"),
        ]

    def after(self, percepts: Percepts, time_s: float) -> np.ndarray:
        """See `Memory`."""
        numbers = np.zeros((len(self._agents), SIDE * SIDE + 5))
        for agent, pose, row in zip(self._agents, percepts.poses, numbers, strict=True):
            row[: SIDE * SIDE] = squares_around(agent.building, pose).ravel()
            row[SIDE * SIDE] = agent.known_share
            path = agent.path_from((float(pose[0]), float(pose[1])), time_s)
            if path is not None:
                along_m, length_m = path
                ahead, left = seen_from(pose[None], np.array([[along_m]]))[0, 0].tolist()
                away_m = math.hypot(ahead, left) or 1.0
                row[SIDE * SIDE + 1 :] = 1.0, ahead / away_m, left / away_m, length_m / self._diagonal_m
        return numbers


class _Explorer:
    """One agent, and the frontier that it has chosen."""

    def __init__(self, setup: Setup, robot_id: int, tuning: FrontierControl) -> None:
        self.building, self._reach_m = setup.map_of(robot_id), setup.robots[robot_id].reach_m
        self._choice, self._replan_s = Choice(robot_id, setup, tuning, arrival=1), tuning.replan_s
        self._goal: Vector | None = None
        self._version, self._chosen_s = -1, 0.0
        """Of the map when it was looked at last, and when the frontier was chosen."""

    @property
    def known_share(self) -> float:
        """The share of the cells within the bounds that are known, 0 to 1."""
        return self.building.shared(_known_share)

    def path_from(self, position: Vector, time_s: float) -> tuple[Vector, float] | None:
        """Return a point of the path to the nearest frontier, about `_AHEAD_M` away, and its length [m].

        None if there is no frontier.
        """
        known = known_map(self.building, self._reach_m)
        has_news, self._version = self.building.version != self._version, self.building.version
        if (has_news and not self._is_frontier()) or time_s >= self._chosen_s + self._replan_s:
            self._goal = self._choice.choose(known, position, (), (), time_s - self._chosen_s)
            self._chosen_s = time_s
        if self._goal is None:
            return None
        along_m, left_m = known.nearest_by_path(self._goal, position, _AHEAD_M)
        return along_m, left_m + math.dist(position, along_m)

    def _is_frontier(self) -> bool:
        """Whether there is an unknown cell next to the frontier that was chosen."""
        if self._goal is None:
            return False
        grid = self.building.grid(CELL_M)
        column, row = (math.floor((at - low) / CELL_M) for at, low in zip(self._goal, grid.origin_m, strict=True))
        return bool((grid.cells[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2] == UNKNOWN).any())


def squares_around(building: MapSource, pose: np.ndarray) -> np.ndarray:
    """Return the map around a robot: 1 for a square with a wall; else 0 (unknown) to -1 (all of it is free).

    Args:    pose: x, y [m], qz, qw.
    Returns: shape (SIDE, SIDE), the first row at its right, the first column behind it. Beyond the map, all is unknown.
    """
    cos, sin = cos_sin(pose)
    size = SIDE * _POINTS
    along_m = (np.arange(size) + 0.5 - 0.5 * size) * (SQUARE_M / _POINTS)
    ahead_m, left_m = along_m[None, :], along_m[:, None]
    grid = building.grid(CELL_M)
    x_m, y_m = pose[0] + cos * ahead_m - sin * left_m, pose[1] + sin * ahead_m + cos * left_m
    seen = cells_at(grid.cells, np.stack((x_m, y_m), axis=-1).reshape(-1, 2), grid.origin_m)
    points = seen.reshape(SIDE, _POINTS, SIDE, _POINTS)
    return np.where((points == OCCUPIED).any((1, 3)), 1.0, -np.mean(points == FREE, (1, 3)))


def _known_share(building: MapSource) -> float:
    return float(np.mean(building.grid(CELL_M).cells != UNKNOWN))
