"""The messages of robots that search, one per iteration, and what they tell of the teammates of one robot."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

import msgspec

from robotteamsim import _core
from robotteamsim.control.rdpso.team import Sighting
from robotteamsim.control.search.cells import NO_CELL
from robotteamsim.interface.payload import Index, Point, Update, update_reader
from robotteamsim.network.messages import Message
from robotteamsim.swarm import Vector

Work = Literal["search", "voice", "area", "wait"]
"""What a robot does: it listens at places, approaches a voice, explores an area, or has nothing to do."""

Level = Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
"""A voice level, or the noise below which none is heard [dB]."""


LONGEST_PATH_M = 1e6
"""A longer path is announced as this [m]."""


class HeardVoice(msgspec.Struct, frozen=True):
    """A voice that a robot approaches: where the victim seems to be, in `map` [m], and the length of the path [m]."""

    source: Point
    path_m: Annotated[float, msgspec.Meta(ge=0.0, le=LONGEST_PATH_M)]


CellNumber = Annotated[int, msgspec.Meta(ge=-1, le=65_535)]
"""A cell; -1 for none."""


class SearchUpdate(Update, frozen=True, tag="search"):
    """What one robot does and knows.

    position:  in `map` [m].
    at:        the cell where it is; -1 if it is far from all free cells.
    work:      what it does.
    goal:      cell to which it drives; -1 if it has none.
    voice:     the voice that it approaches; None if it approaches none.
    noise_db:  its estimate of the noise; None if no voice has shown it.
    elapsed_s: time of the mission, as far as it knows [s].
    found:     places of victims whom the team has reached, in `map` [m].
    listened:  entries of `ListeningLog`.
    doors:     sightings of doors, sorted by name.
    hot:       blocks of hot places that the robot sees, sorted; left out by a robot that sees none.
    closed_area: centre of the area of the task, if the robot knows no path to it; else left out.
    wanted:    cell where it wants to be next, of a team that stays connected.
    held:      whether it has been held for long in such a team; left out if not.
    """

    robot_id: Index
    position: Point
    at: CellNumber
    work: Work
    goal: CellNumber
    voice: HeardVoice | None
    noise_db: Level | None
    elapsed_s: Annotated[float, msgspec.Meta(ge=0.0, le=1e9)]
    found: tuple[Point, ...]
    listened: str
    doors: tuple[Sighting, ...] = ()
    hot: tuple[tuple[Index, Index], ...] | msgspec.UnsetType = msgspec.UNSET
    closed_area: Point | msgspec.UnsetType = msgspec.UNSET
    wanted: CellNumber | msgspec.UnsetType = msgspec.UNSET
    held: bool | msgspec.UnsetType = msgspec.UNSET


_parse = update_reader(SearchUpdate, kept=1024)


def update_of(message: Message) -> SearchUpdate | None:
    """Return the update in a message; None if it is another message, or the update of another robot than its sender."""
    update = _parse(message.payload)
    return update if update is not None and update.robot_id == message.sender else None


_MUCH_SHORTER = 0.8
"""A robot without work takes over the goal of a teammate if its own path to it is at most this share of theirs."""


class Teammates:
    """The last update of each teammate that was heard recently."""

    def __init__(self, robot_id: int, given_up_s: float) -> None:
        self.robot_id = robot_id
        self._given_up_s = given_up_s
        self._heard_s: dict[int, float] = {}
        self._updates: dict[int, SearchUpdate] = {}
        """In the order of ids."""
        self.positions: Mapping[int, Vector] = {}
        """The last position of each, in `map` [m], by id."""

    def hear(self, update: SearchUpdate, time_s: float) -> None:
        """Store an update. Args: time_s: of its arrival [s]."""
        is_new = update.robot_id not in self._updates
        self._updates[update.robot_id] = update
        if is_new:
            self._updates = dict(sorted(self._updates.items()))
        self._heard_s[update.robot_id] = time_s
        self.positions = {**self.positions, update.robot_id: update.position}

    def forget_lost(self, time_s: float) -> None:
        """Forget the teammates that have not been heard for too long."""
        for robot_id in [i for i, heard_s in self._heard_s.items() if time_s - heard_s > self._given_up_s]:
            del self._heard_s[robot_id], self._updates[robot_id]
            self.positions = {i: place for i, place in self.positions.items() if i != robot_id}

    def silent(self, time_s: float, for_s: float) -> list[int]:
        """Return the ids of the teammates that have not been heard for some time."""
        return [robot_id for robot_id, heard_s in self._heard_s.items() if time_s - heard_s > for_s]

    @property
    def updates(self) -> list[SearchUpdate]:
        """The last updates, in the order of ids."""
        return list(self._updates.values())

    @property
    def claims(self) -> list[int]:
        """Cells at which teammates will listen."""
        return [update.goal for update in self._listening]

    def kept_claims(self, at: int, paths: _core.control.CellPaths) -> list[int]:
        """Return the claims without those to which this robot has a much shorter path. Args: at: its cell."""
        return [
            update.goal
            for update in self._listening
            if _length_m(paths, update.goal, at) >= _MUCH_SHORTER * _length_m(paths, update.goal, update.at)
        ]

    @property
    def _listening(self) -> list[SearchUpdate]:
        """The last updates of those that will listen somewhere."""
        return [update for update in self.updates if update.goal != NO_CELL and update.work != "voice"]

    def prior_claims(self, goal: int, at: int, paths: _core.control.CellPaths) -> list[int]:
        """Return those that are nearer to their robots than a goal to this one; of equally near ones, the id decides.

        Args: at: the cell of this robot.
        """
        own = (_length_m(paths, goal, at), self.robot_id)
        return [
            update.goal
            for update in self._listening
            if (_length_m(paths, update.goal, update.at), update.robot_id) < own
        ]

    def lengths_m(
        self, cell: int, at: int, paths: _core.control.CellPaths, works: Sequence[Work] = ()
    ) -> list[tuple[float, int]]:
        """Return the path lengths to a cell from this robot and its teammates [m], with their ids.

        Args: at: the cell of this robot.  works: of the teammates to consider; empty for all.
        """
        others = [update for update in self.updates if update.at != NO_CELL and (not works or update.work in works)]
        lengths_m = [(paths.length_m(cell, update.at), update.robot_id) for update in others]
        return [(_length_m(paths, cell, at), self.robot_id), *lengths_m]

    @property
    def all_wait(self) -> bool:
        """Whether all have nothing to do."""
        return all(update.work == "wait" for update in self._updates.values())

    def approaches(self, source_m: Vector, path_m: float, same_voice_m: float) -> bool:
        """Whether a teammate approaches a voice on a shorter path, or on one as long with a lower id."""
        return any(
            update.voice is not None
            and math.dist(update.voice.source, source_m) <= same_voice_m
            and (update.voice.path_m, update.robot_id) < (path_m, self.robot_id)
            for update in self._updates.values()
        )


def _length_m(paths: _core.control.CellPaths, goal: int, at: int) -> float:
    """Return the length of a path [m]; infinity if there is none."""
    return paths.length_m(goal, at) if NO_CELL not in (goal, at) else math.inf
