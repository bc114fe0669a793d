"""Base class of the controllers that search a plan: they follow their route until they hear a voice."""

from __future__ import annotations

import abc
import math
from collections.abc import Sequence

from robotteamsim.control.driving.known_map import Disc
from robotteamsim.control.driving.path_controller import PathController, Situation
from robotteamsim.control.rdpso.terms import RuledOut
from robotteamsim.control.search.areas import RemainingAreas
from robotteamsim.interface import Decision, Task
from robotteamsim.network.messages import Message
from robotteamsim.scenario.controllers.routes import RouteControl
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

LONGEST_TIMED_M = 1000.0
"""Limit of the length in the timeout [m]: places without a free path have a huge length, but must time out as well."""

_MOST_SKIPPED = 20
"""After so many places without a path, a robot stands still until the next step."""


class RouteController(PathController, abc.ABC):
    """Drives to the loudest cell of a voice, unless no victim can be there, and otherwise along its own route.

    The voice is judged once per iteration, as `greedy` does. A voice that does not become louder for a while, because
    its loudest cell cannot be reached, is ignored there until the voice map changes. Areas have no influence, but the
    last one, which ends the mission, is not entered before the floor has been searched.
    """

    def __init__(self, robot_id: int, setup: Setup, tuning: RouteControl) -> None:
        super().__init__(robot_id, setup)
        self._tuning = tuning
        self._areas = RemainingAreas(setup.scenario)
        self._ruled_out = RuledOut(setup.scenario, tuning.rule_out_places)
        self._iteration_ns = round(setup.scenario.control.iteration_s * 1e9)
        self._iteration = self._epoch = -1
        self._voice_m: Vector | None = None
        """The loudest cell, if a victim can be there."""
        self._level_db, self._louder_s = -math.inf, 0.0
        """The loudest level so far of the voice that it follows [dB], and since when."""
        self._ignored: list[Vector] = []
        """Where voices are ignored."""
        self._place: Vector | None = None
        self._until_s = 0.0
        self._kept_out_now: Disc | None = None
        self._save_distance_m = setup.scenario.mission.save_distance_m

    def decide(self, now: Situation) -> Decision:
        """Return the command of this step, and the messages of a new iteration."""
        outbox: tuple[Message, ...] = ()
        iteration = now.observation.sim_time_ns // self._iteration_ns
        if now.task.epoch != self._epoch:
            self._epoch = now.task.epoch
            self._ruled_out.clear()
            self._ignored.clear()
            self._forget_voices()
        self._listen(now.inbox)
        if iteration != self._iteration:
            self._iteration = iteration
            self._judge_voice(now)
            outbox = self._look(now)
        if self._voice_m is not None:
            self._place = None  # The time on the way to a victim does not count for the route.
            return self.drive(now, self._voice_m, outbox)
        if self._place is None or self._is_done(self._place, now):
            self._place = self._next_outside(now.position)
            if self._place is None:
                return self.stand(now, outbox)
            self._set_out(self._place, now)
        return self.drive(now, self._place, outbox)

    @abc.abstractmethod
    def _next_place(self, position: Vector, is_done: bool) -> Vector:
        """Return the next place of the route; `is_done`: the last one was reached or given up, not only interrupted."""

    @property
    @abc.abstractmethod
    def is_searched(self) -> bool:
        """Whether the robot knows that the whole floor has been searched."""

    def kept_out(self, task: Task) -> Disc | None:
        """Return the last area until the floor has been searched."""
        self._areas.follow(task)
        kept_out = None if self.is_searched else self._areas.kept_out_soon
        if kept_out != self._kept_out_now:
            self._kept_out_now, self._place = kept_out, None
        return kept_out

    def _next_outside(self, position: Vector) -> Vector | None:
        """Return the next place of the route to which a path leads outside the last area; None if several have none."""
        is_done = self._place is not None
        for _ in range(_MOST_SKIPPED):
            place = self._outside(self._next_place(position, is_done), position)
            if place is not None:
                return place
            is_done = True
        return None

    def _outside(self, place: Vector, position: Vector) -> Vector | None:
        """Return where to drive to reach a place, or a victim there, outside the last area; None without a path."""
        if self._kept_out_now is None:
            return place
        known, grid = self.driver.map, self.driver.map.grid
        start, free = grid.nearest_free(position, 1.0), grid.nearest_free(place, self._save_distance_m)
        if start is None or free is None or grid.is_line_free(start, free):
            return free
        return free if known.has_path(start, free, LONGEST_TIMED_M) else None

    def _listen(self, inbox: Sequence[Message]) -> None:
        """Process the messages of this step; none by default."""

    def _forget_voices(self) -> None:
        """The voice map has changed: forget what depends on it; nothing by default."""

    def _look(self, now: Situation) -> tuple[Message, ...]:
        """Process the observation of a new iteration and return its messages; none by default."""
        return ()

    def _judge_voice(self, now: Situation) -> None:
        voice = now.observation.voice
        loudest = voice.local_best_m if voice.heard else None
        self._ruled_out.add(now.position, loudest)
        if loudest is None or self._ruled_out.covers(loudest) or self._is_ignored(loudest):
            self._voice_m = None
            return
        if self._voice_m is None or voice.local_best_level_db > self._level_db:
            self._level_db, self._louder_s = voice.local_best_level_db, now.time_s
        self._voice_m = self._outside(loudest, now.position)
        if now.time_s - self._louder_s > self._tuning.voice_timeout_s:
            self._ignored.append(loudest)
            self._voice_m = None

    def _is_ignored(self, place: Vector) -> bool:
        radius_m = self.scenario.voice.local_best_radius_m
        return any(math.dist(place, ignored) <= radius_m for ignored in self._ignored)

    def _is_done(self, place: Vector, now: Situation) -> bool:
        return math.dist(now.position, place) < self._tuning.arrived_m or now.time_s > self._until_s

    def _set_out(self, place: Vector, now: Situation) -> None:
        """Set how long the robot tries to get to a place."""
        length_m = self.driver.map.grid.first_stretch(now.position, place, LONGEST_TIMED_M)[1]
        travel_s = self._tuning.timeout_factor * min(length_m, LONGEST_TIMED_M) / self.speed_mps
        self._until_s = now.time_s + self._tuning.timeout_s + travel_s
