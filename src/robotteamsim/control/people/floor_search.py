"""Searching the floor: to uncovered places that nobody else goes to."""

from __future__ import annotations

import math

import msgspec

from robotteamsim.control.cover.floor_cover import CoverUpdate, FloorCover
from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.controllers.cover import FloorSearchTuning
from robotteamsim.scenario.fire import Block
from robotteamsim.setup import Setup

_SLOWEST_MPS = 0.3
"""Who approaches a place more slowly than this, as the crow flies, gives it up."""


class FloorSearch:
    """The floor that somebody knows to be searched, and where they go next.

    Robots with the controller `cover` and firefighters exchange `CoverUpdate`, so that nobody searches a place twice.
    """

    def __init__(self, robot_id: int, setup: Setup, tuning: FloorSearchTuning) -> None:
        self._robot_id = robot_id
        self._tuning = tuning
        reach_m, start = setup.robots[robot_id].reach_m, setup.start_m(robot_id)
        self._cover = FloorCover(setup.building, reach_m, start, tuning.radius_m)
        self._others: dict[int, CoverUpdate] = {}
        self._avoided: list[tuple[Point, float]] = []
        """Places that could not be reached, and until when they are avoided [s]."""
        self.goal: Point | None = None
        """The place to go to, in `map` [m]."""
        self._give_up_s = 0.0
        """When the goal has not been reached in time [s]."""

    def hear(self, update: CoverUpdate) -> None:
        """Note what a teammate has searched and where they go."""
        self._cover.merge(update.covered)
        self._others[update.robot_id] = update

    def look(self, position: Point) -> None:
        """Note what is seen from a place in `map` [m]."""
        self._cover.look(position)

    def choose(self, position: Point, time_s: float, hot: HotPlaces) -> Point | None:
        """Return the place to search next, which is not hot; None: everything else is searched."""
        self._avoided = [(place, until_s) for place, until_s in self._avoided if until_s > time_s]
        if self.goal is not None and time_s > self._give_up_s:
            self._avoided.append((self.goal, time_s + self._tuning.avoided_s))
            self.goal = None
        if self.goal is None or self._cover.is_covered(self.goal) or hot.is_hot(self.goal):
            left_out = [(place, self._tuning.avoided_m) for place, _ in self._avoided]
            left_out += [(other.goal, self._tuning.apart_m) for other in self._others.values() if other.goal]
            self.goal = self._cover.best_place(position, left_out, self._tuning.nearness_m, hot=hot.known)
            if self.goal is not None:
                walk_s = math.dist(position, self.goal) / _SLOWEST_MPS
                self._give_up_s = time_s + self._tuning.goal_timeout_s + walk_s
        return self.goal

    def pause(self) -> None:
        """Go nowhere for now."""
        self.goal = None

    def update(self, position: Point, hot: tuple[Block, ...] = ()) -> CoverUpdate:
        """Return the message to the team. Args: hot: the hot places in sight."""
        return CoverUpdate(self._robot_id, position, self.goal, self._cover.to_hex(), (), hot or msgspec.UNSET)
