"""What the robots of a swarm tell each other once per iteration."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import NamedTuple

from robotteamsim.interface import OUTSIDE
from robotteamsim.network.messages import Message
from robotteamsim.swarm import SwarmState, Vector

_KEPT = 8192
_KNOWN: dict[str, RdpsoUpdate | None] = {}
"""What texts say that this process wrote or has read, for all of its robots; text keeps every bit."""


Sighting = tuple[str, bool, int]
"""Door's name, whether it was closed, and the iteration in which that was seen."""


class Best(NamedTuple):
    """A place and what it is worth: larger is better; any heard voice is worth more than any distance to an area."""

    value: float
    position: Vector

    @property
    def is_voice(self) -> bool:
        """Whether the value is a voice level; otherwise it is the distance to the area, negative."""
        return is_voice(self.value)


def is_voice(value: float) -> bool:
    """Whether the value of a best is a voice level; otherwise it is the distance to the area, negative."""
    return value > 0.0


NOTHING: tuple[float, None] = float("-inf"), None
"""In place of a best where nothing draws the robot: below any other."""


class RdpsoUpdate(NamedTuple):
    """One robot's view at the start of an iteration; positions in `map` [m].

    epoch:      of the task; bests of different epochs, or of robots that disagree on doors, are not comparable.
    loudest:    the loudest cell that it hears; none if it hears no voice.
    local_best: none where nothing draws the robot.
    known_best: the best that it knows of since bests were last reset, before this iteration.
    swarm_id:   the swarm that it belongs to, before this iteration; OUTSIDE: it is socially excluded.
    swarm:      its copy of that swarm's memory, before this iteration.
    doors:      what it knows of doors beyond the plan: (name, closed, iteration in which that was seen), by name.
    """

    robot_id: int
    iteration: int
    epoch: int
    position: Vector
    loudest: Vector | None
    local_best: Best | None
    known_best: Best | None
    swarm_id: int
    swarm: SwarmState
    doors: tuple[Sighting, ...] = ()

    def to_json(self) -> str:
        """Return the report as one line of JSON; numbers keep every bit."""
        robot_id, iteration, epoch, position, loudest, local_best, known_best, swarm_id, swarm, doors = self
        search_counter, num_killed = swarm
        text = json.dumps(
            {
                "robot": robot_id,
                "iteration": iteration,
                "epoch": epoch,
                "position": position,
                "loudest": loudest,
                "local_best": _row(local_best),
                "known_best": _row(known_best),
                "swarm": swarm_id,
                "search_counter": search_counter,
                "num_killed": num_killed,
                "doors": doors,
            }
        )
        _keep(text, self)
        return text

    @property
    def excluded(self) -> bool:
        """Whether it is socially excluded."""
        return self.swarm_id == OUTSIDE

    @property
    def value(self) -> float:
        """Value of the local best; below any other where there is none."""
        value, _ = self.local_best or NOTHING
        return value


def parse_update(payload: str) -> RdpsoUpdate | None:
    """Return the report that a message carries; none where it carries something else."""
    if payload not in _KNOWN:
        _keep(payload, _read(payload))
    return _KNOWN[payload]


def _keep(payload: str, report: RdpsoUpdate | None) -> None:
    if len(_KNOWN) >= _KEPT:
        _KNOWN.clear()
    _KNOWN[payload] = report


def _read(payload: str) -> RdpsoUpdate | None:
    try:
        data = json.loads(payload)
        return RdpsoUpdate(
            robot_id=int(data["robot"]),
            iteration=int(data["iteration"]),
            epoch=int(data["epoch"]),
            position=to_vector(data["position"]),
            loudest=None if data["loudest"] is None else to_vector(data["loudest"]),
            local_best=_to_best(data["local_best"]),
            known_best=_to_best(data["known_best"]),
            swarm_id=int(data["swarm"]),
            swarm=SwarmState(int(data["search_counter"]), int(data["num_killed"])),
            doors=tuple((str(name), bool(closed), int(iteration)) for name, closed, iteration in data["doors"]),
        )
    except (ValueError, KeyError, TypeError):
        return None


def updates_in(inbox: Iterable[Message]) -> list[RdpsoUpdate]:
    """Return the reports that messages carry, and nothing for those that carry something else."""
    # Most are known: a robot of a large team hears a hundred in every iteration.
    known = _KNOWN.get
    reports = []
    for message in inbox:
        report = known(message.payload) or parse_update(message.payload)
        if report:
            reports.append(report)
    return reports


def _row(best: Best | None) -> tuple[float, float, float] | None:
    if best is None:
        return None
    value, (x, y) = best
    return value, x, y


def _to_best(data: list[float] | None) -> Best | None:
    if data is None:
        return None
    value, x, y = data
    return Best(float(value), (float(x), float(y)))


def to_vector(data: list[float]) -> Vector:
    """Return the x and y that a message has as a list. Raises: ValueError, TypeError: it is no list of two numbers."""
    x, y = data
    return float(x), float(y)
