"""The survey of a building that nobody knows: each robot maps what it sees, and shares it with its team."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from robotteamsim.geometry import Pose
from robotteamsim.interface import Estimate, Localisation, Observation
from robotteamsim.interface.survey_news import (
    IS_FREE,
    IS_OCCUPIED,
    IS_UNKNOWN,
    SAME,
    Cells,
    SurveyNews,
    bounds,
    packed,
    unpacked,
)
from robotteamsim.maps.found_map import FoundMap, Part
from robotteamsim.maps.localiser import Localiser
from robotteamsim.maps.merging import Merging, is_open, moving_places
from robotteamsim.maps.own_map import OwnMap, cells_at, overlap, whole
from robotteamsim.maps.recent_scans import LaserView, moved
from robotteamsim.maps.teammates import Disc
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN
from robotteamsim.setup import Setup

_LONGEST = 1200
"""Characters of the cells in one message: with the rest of it, it fits into a packet of 1,500 bytes."""

_CELLS = np.zeros(4, dtype=np.int8)
"""What the symbols in a message mean."""
_CELLS[[SAME, IS_UNKNOWN, IS_FREE, IS_OCCUPIED]] = [UNKNOWN, UNKNOWN, FREE, OCCUPIED]

_CERTAIN = (0.0,) * 6
"""Covariance of a pose that is given."""

_OTHERS = 300
"""Characters of the rest of a message, at most."""


class Survey:
    """What one robot knows of a building: its own map, and what its teammates sent of theirs; a `Localiser`.

    Where both know something, its own map counts. Every `share_s`, a robot sends what has changed in its own map and
    is not as anybody has said last. Messages have numbers: who lost one, or was out of reach, asks its sender for all
    that it knows, until it gets the answer.

    found: all of it; `Setup.map_of` returns it.
    """

    looks = True
    particles = ()

    def __init__(self, robot_id: int, setup: Setup, found: FoundMap, given: Localiser | None, arrival: int = 1) -> None:
        """Args: given: knows the robot's pose; None: the mapper finds it.

        arrival: number of the robot's arrivals; one that comes back does not know where it is.
        """
        self._robot_id, self.found, self._given = robot_id, found, given
        body = setup.robots[robot_id]
        self._view = LaserView(body.laser)
        mapping, knows_start = setup.scenario.control.mapping, given is not None or setup.knows_start(robot_id, arrival)
        start = Pose(*body.start_pose) if knows_start else setup.middle
        self._own = OwnMap(body.laser, mapping, start, found, may_move=not knows_start)
        self._merging = None if knows_start else Merging(self._view, setup.smallest_reach_m, found)
        """Until the robot knows where it started."""
        self._place: Pose | None = None
        """Where it has found that its own map lies in `map`, to which it moves in the next step."""
        self._reported: list[Point] | None = None
        """Where teammates see something move, if they have sent news since the last step; else None."""
        self._without_place: set[int] = set()
        """The teammates who do not know where they are."""
        self._scan: tuple[np.ndarray, Sequence[Disc]] | None = None
        """The last one, and where teammates might be then."""
        self._heard: list[Part] = []
        """Where teammates have found something since the last look."""
        self._of_team = found.cells.copy()
        self._unsent = np.zeros(found.cells.shape, dtype=bool)
        self._said = found.cells.copy()
        """What anybody has said last about each cell."""
        self._is_asked = False
        """Whether a teammate wants all that it knows."""
        self._period_ns = round(mapping.share_s * 1e9)
        self._due_ns, self._answered_ns = 0, -self._period_ns
        self._number = 0
        """Of the next message with cells."""
        self._expected: dict[int, int] = {}
        """The number of the next message with cells of each teammate."""
        self._wanted: set[int] = set()
        """The teammates of whom it wants all that they know."""
        limit = setup.scenario.network.max_message_bytes
        self._longest = max(min(_LONGEST, limit - _OTHERS), 1)

    def pose(self, observation: Observation, teammates: Sequence[Disc] = ()) -> Pose:
        """Return the pose in a step, after it has mapped what the laser sees."""
        reading = observation.robot.odometry
        odometry, covariance, ranges_m = reading.pose.pose, reading.pose_covariance, observation.robot.ranges_m
        if self._given is not None:
            odometry, covariance = self._own.to_frame(self._given.pose(observation)), _CERTAIN
        masked = np.zeros(len(ranges_m), dtype=bool)
        due_at = self._own.due_at(odometry)
        if due_at is not None and self._merging is None:
            # A wall that is known stays one while a teammate is beside it.
            ends_m = self._view.ends_m(ranges_m)
            is_wall = cells_at(self.found.cells, moved(due_at, ends_m), self.found.origin_m) == OCCUPIED
            masked = self._view.end_in(teammates, due_at, ends_m) & ~is_wall
        self._own.step(odometry, covariance, ranges_m, masked)
        self._scan = ranges_m, teammates
        if self._merging is not None and self._reported is not None:
            self._merging.note(self._own.pose, ranges_m, teammates, self._reported, self._own.cells)
        self._reported = None
        if self._place is not None:
            self._own.move(self._place)
            self._merging = self._place = None
            self._heard.append(whole(self.found.cells))
            self.look()
        return self._own.pose

    @property
    def is_placed(self) -> bool:
        """Whether the robot knows where it is in the map of its team."""
        return self._merging is None

    @property
    def localisation(self) -> Localisation:
        """What the robot knows as of the last step."""
        if self._merging is not None:
            return self._merging.localisation(self._own.pose)
        estimate = Estimate(self._own.pose, self._own.covariance)
        return Localisation("lost" if self._own.is_lost else "tracking", (estimate,))

    def look(self) -> None:
        """Show in `found` what the robot and its teammates have found by now."""
        own, of_team = self._own.cells, self._of_team
        rectangle, changed = self._own.take_changes()
        self._unsent[rectangle] |= changed
        if self._merging is not None:
            self.found.show([(rectangle, own[rectangle])])
            self._place = self._merging.search(self._own.pose, own, of_team)
            return
        parts: list[Part] = [rectangle, *self._heard]
        self._heard = []
        known = (np.where(own[part] == UNKNOWN, of_team[part], own[part]) for part in parts)
        self.found.show(list(zip(parts, known, strict=True)))

    def _what_moves(self) -> tuple[Point, ...]:
        """Return where something moves that is no teammate whose position is known, in `map` [m]."""
        if self._scan is None:
            return ()
        ranges_m, teammates = self._scan
        ends_m = self._view.ends_m(ranges_m)
        in_map_m = moved(self._own.pose, ends_m)
        moving = self._view.hits(ranges_m) & is_open(self._own.cells, in_map_m, self.found.origin_m)
        return moving_places(in_map_m, moving & ~self._view.end_in(teammates, self._own.pose, ends_m))

    def hear(self, sender: int, news: SurveyNews, sim_time_ns: int) -> None:
        """Take over what a teammate has found, and note whether some of it was lost."""
        if news.position is None:
            self._without_place.add(sender)
        else:
            self._without_place.discard(sender)
            self._reported = [*(self._reported or ()), *news.moving]
        if self._robot_id in news.wanted and sim_time_ns >= self._answered_ns + self._period_ns:
            self._is_asked = True
        if news.number != self._expected.get(sender, 0):
            self._wanted.add(sender)
        elif news.is_all:
            self._wanted.discard(sender)
        self._expected[sender] = news.number + (news.cells is not None)
        found = None if news.cells is None else _changed_by(news.cells, self._of_team.shape)
        if found is not None:
            changed, cells = found
            self._of_team[changed] = self._said[changed] = cells
            if self._merging is None:
                self._heard.append(changed)

    def news(self, position: Point | None, sim_time_ns: int) -> Iterator[SurveyNews]:
        """Yield what the robot has to say now: one message or more. Args: position: of the robot, in `map` [m]."""
        wanted, is_all = tuple(sorted(self._wanted)), self._is_asked
        moving = self._what_moves() if self._without_place and position is not None else ()
        parts: list[Cells | None] = list(self._cells_to_send(sim_time_ns))
        for part in parts or [None]:
            yield SurveyNews(position, self._number, part, is_all, wanted, moving)
            self._number += part is not None
            wanted, moving, is_all = (), (), False

    def _cells_to_send(self, sim_time_ns: int) -> Iterator[Cells]:
        """Yield what has changed in the robot's own map and is not as anybody has said last, if that is due.

        If a teammate has asked for it, yield all that the robot knows.
        """
        if self._merging is not None or (not self._is_asked and sim_time_ns < self._due_ns):
            return
        self._due_ns = sim_time_ns + self._period_ns
        known = self.found.cells
        if self._is_asked:
            self._answered_ns = sim_time_ns
            to_send = (known != UNKNOWN) | (self._said != UNKNOWN)
        else:
            to_send = self._unsent & (known != self._said)
        self._is_asked, self._unsent[:] = False, False
        np.copyto(self._said, known, where=to_send)
        part = rows, columns = bounds(to_send)
        symbols = np.select([known[part] == FREE, known[part] == OCCUPIED], [IS_FREE, IS_OCCUPIED], IS_UNKNOWN)
        yield from packed(
            np.where(to_send[part], symbols, SAME).astype(np.uint8), self._longest, rows.start, columns.start
        )


@lru_cache(maxsize=64)
def _changed_by(cells: Cells, shape: tuple[int, ...]) -> tuple[Part, np.ndarray] | None:
    """Return which cells of a map a message changes, and what they become, int8; None if it is not valid.

    All receivers of a message share it. Args: shape: of the map.
    """
    symbols = unpacked(cells, math.prod(shape))
    if symbols is None:
        return None
    (here_rows, here_columns), there = overlap(shape, cells.row, cells.column, symbols.shape)
    rows, columns = np.nonzero(symbols[there] != SAME)
    return (rows + here_rows.start, columns + here_columns.start), _CELLS[symbols[there][rows, columns]]
