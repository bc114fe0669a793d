"""Seeing people: within a distance, in a straight line that no solid and no closed door crosses."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely

from robotteamsim.rng import stream
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import Solid
from robotteamsim.scenario.rescue import Rescue
from robotteamsim.world.core_parts import still_solids
from robotteamsim.world.doors import DoorStates, leaf_outline


class Sight:
    """The eyes of robots and firefighters, which see in all directions. Random streams: ("sight", id)."""

    def __init__(self, plan: FloorPlan, section: Rescue, team_size: int, seed: int) -> None:
        self._plan = plan
        self._range_m, self._error = section.sight_m, section.sight_error
        _, self._solids = still_solids(plan)
        self._streams = [stream(seed, "sight", robot_id) for robot_id in range(team_size)]
        self._doors_version = -1
        self._leaves: list[shapely.Polygon] = []
        self.follow_doors(DoorStates.at_start(plan))

    def follow_doors(self, doors: DoorStates) -> None:
        """Look past the doors in these states."""
        if doors.version == self._doors_version:
            return
        self._doors_version = doors.version
        leaves = ((door, leaf_outline(door, doors[door.name])) for door in self._plan.doors)
        self._leaves = [Solid(door.name, "door", corners, door).polygon for door, corners in leaves if corners]

    def pairs(
        self, positions_m: np.ndarray, people_m: Sequence[Point], visibility_m: np.ndarray | None = None
    ) -> list[tuple[int, int]]:
        """Return who sees whom: pairs of observer and person, by person and then by distance.

        Args: positions_m:  of the observers, shape (n, 2), in `map` [m]; NaN for those who are absent.
              visibility_m: in the smoke at each observer [m], shape (n,); None: there is no smoke.
        """
        if not people_m:
            return []
        away = positions_m[:, None, :] - np.array(people_m)[None, :, :]
        distances_m = np.hypot(away[..., 0], away[..., 1])
        reach_m: np.ndarray | float = self._range_m
        if visibility_m is not None:
            reach_m = np.minimum(self._range_m, visibility_m)[:, None]
        near = np.argwhere((distances_m <= reach_m).T)
        ordered = sorted((person, distances_m[robot, person], robot) for person, robot in near.tolist())
        if not ordered:
            return []
        lines = shapely.linestrings([(positions_m[robot], people_m[person]) for person, _, robot in ordered])
        is_blocked = np.zeros(len(ordered), dtype=bool)
        is_blocked[self._solids.query(lines, predicate="intersects")[0]] = True
        for leaf in self._leaves:
            is_blocked |= shapely.intersects(leaf, lines)
        return [(robot, person) for (person, _, robot), blocked in zip(ordered, is_blocked, strict=True) if not blocked]

    def measured_m(self, robot_id: int, position_m: Point, person_m: Point) -> Point:
        """Return where an observer at a position believes to see a person; the error grows with the distance [m]."""
        deviation_m = self._error * math.dist(position_m, person_m)
        error_x, error_y = (deviation_m * self._streams[robot_id].standard_normal(2)).tolist()
        return person_m[0] + error_x, person_m[1] + error_y
