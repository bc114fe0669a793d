"""Searching the floor: to uncovered places that nobody else goes to."""

from __future__ import annotations

import math

import msgspec

from robotteamsim.control.cover.floor_cover import CoverUpdate, FloorCover
from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.controllers.cover import FloorSearchTuning
from robotteamsim.scenario.fire import HotBlock
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import Setup

_LOUDER_DB = 0.5
"""A voice that becomes louder by less is no progress [dB]."""

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
        self._cover = FloorCover(
            setup.map_of(robot_id), reach_m, start, tuning.radius_m, setup.scenario.travels_as(robot_id)
        )
        self._others: dict[int, CoverUpdate] = {}
        self._avoided: list[tuple[Point, float]] = []
        """Places that could not be reached, and until when they are avoided [s]."""
        self.goal: Point | None = None
        """The place to go to, in `map` [m]."""
        self._voice_db, self._voice_until_s = -math.inf, 0.0
        """The loudest level of the voice that is followed [dB], and until when it must become louder [s]."""
        self._give_up_s = 0.0
        """When the goal has not been reached in time [s]."""

    def hear(self, update: CoverUpdate) -> None:
        """Note what a teammate has searched and where they go."""
        self._cover.merge(update.covered)
        self._others[update.robot_id] = update

    def look(self, position: Point) -> None:
        """Note what is seen from a place in `map` [m]."""
        self._cover.look(position)

    def follow(self, position: Point, voice: VoiceReading, time_s: float) -> Point | None:
        """Return the loudest place near somebody who hears a voice and is not served by others; else None.

        A voice that becomes no louder is given up, and those near that place are not followed for some time.
        """
        place, level_db = voice.local_best_m, voice.local_best_level_db
        if not voice.heard or self._is_avoided(place, time_s) or self._is_taken(place, position):
            self.leave_voice()
            return None
        if level_db >= self._voice_db + _LOUDER_DB:
            self._voice_db, self._voice_until_s = level_db, time_s + self._tuning.goal_timeout_s
        elif time_s > self._voice_until_s:
            self._avoided.append((place, time_s + self._tuning.avoided_s))
            self.leave_voice()
            return None
        self.goal = place  # others search elsewhere
        return place

    def leave_voice(self) -> None:
        """Go on with the search, if a voice was followed."""
        if math.isfinite(self._voice_db):
            self.goal, self._voice_db = None, -math.inf

    def _is_avoided(self, place: Point, time_s: float) -> bool:
        self._avoided = [(avoided, until_s) for avoided, until_s in self._avoided if until_s > time_s]
        return any(math.dist(place, avoided) <= self._tuning.avoided_m for avoided, _ in self._avoided)

    def _is_taken(self, place: Point, position: Point) -> bool:
        """Whether a teammate that is nearer, or as near with a lower id, goes there."""
        own = math.dist(place, position), self._robot_id
        return any(
            other.goal is not None
            and math.dist(place, other.goal) < self._tuning.apart_m
            and (math.dist(place, other.position), robot_id) < own
            for robot_id, other in self._others.items()
        )

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
        self.goal, self._voice_db = None, -math.inf

    def update(self, position: Point, hot: tuple[HotBlock, ...] = ()) -> CoverUpdate:
        """Return the message to the team. Args: hot: the hot places in sight."""
        return CoverUpdate(self._robot_id, position, self.goal, self._cover.to_hex(), (), hot or msgspec.UNSET)
