"""A frame: everything that a viewer shows of one moment of a mission."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Literal, Protocol

import msgspec
import numpy as np

from robotteamsim.interface import OUTSIDE
from robotteamsim.mission.events import AnyEvent
from robotteamsim.scenario.sections import Victim
from robotteamsim.simulation import StepRecord
from robotteamsim.world.contract import AnyWorld

Pose = tuple[float, float, float]
"""x, y [m], yaw [rad] in `map`."""

Link = tuple[int, int, int]
"""Two robots, the smaller index first, and the signal between them [dBm]."""

FAR_M = 1000.0
"""Replaces an infinite range [m]; the page draws beams up to the laser's longest range."""

UNKNOWN_SIGNAL_DBM = 5_000
"""Signal of a link in a recording without signals; larger than any signal."""


Gait = Literal["lies", "walks", "flees"]
"""Whether a victim has to be carried, can follow a firefighter, or walks to an exit alone."""


class VictimShape(msgspec.Struct, frozen=True):
    """A victim: where they are [m], their state, and how they move."""

    name: str
    position_m: tuple[float, float]
    state: str
    gait: Gait = "lies"


class ShownEvent(msgspec.Struct, frozen=True):
    """An event with the time of the frame in which it is shown [s]."""

    time_s: float
    kind: str
    text: str


class Frame(msgspec.Struct, frozen=True):
    """One moment of a mission.

    time_s:  since the start of the world, or of the recorded mission [s].
    poses:   of each robot; None: it is absent.
    swarms:  of each robot; -1: it is excluded.
    links:   that exist.
    doors:   opening of each door, 0 closed .. 1 open.
    objects: pose of each object.
    explored, target: whether each area is explored; the area to explore now, -1 for none.
    endangered: how often a link became endangered so far.
    scans_m: ranges of each robot's laser; empty in frames without scans.
    """

    time_s: float
    poses: tuple[Pose | None, ...]
    swarms: tuple[int, ...] = ()
    links: tuple[Link, ...] = ()
    fiedler_value: float = 0.0
    doors: tuple[float, ...] = ()
    objects: tuple[Pose, ...] = ()
    victims: tuple[VictimShape, ...] = ()
    explored: tuple[bool, ...] = ()
    target: int = -1
    state: str = ""
    noise_db: float = 0.0
    endangered: int = 0
    scans_m: tuple[list[float], ...] = ()


def frame_of(record: StepRecord, world: AnyWorld, *, with_scans: bool, fallen: Collection[str] = frozenset()) -> Frame:
    """Return the frame of a step. Args: world: just after that step, for its objects.  fallen: as `victim_shapes`."""
    scans = [finite_ranges(reading.ranges_m, FAR_M) for reading in record.readings] if with_scans else []
    poses = []
    for robot_id, reading in enumerate(record.readings):
        pose = reading.true_pose
        poses.append((pose.x_m, pose.y_m, pose.yaw_rad) if record.is_there(robot_id) else None)
    status = record.mission
    return Frame(
        time_s=record.sim_time_s,
        poses=tuple(poses),
        swarms=tuple(OUTSIDE if decision.excluded else decision.swarm for decision in record.decisions),
        links=links_of(record.network.adjacency, record.network.rssi_dbm),
        fiedler_value=record.network.fiedler_value,
        doors=tuple(state.opening for state in record.doors.values()),
        objects=tuple((pose.x_m, pose.y_m, pose.yaw_rad) for pose in world.objects().values()),
        victims=victim_shapes(record.victims, status.victims, fallen, enclosed_of(record.people)),
        explored=status.explored,
        target=status.target_area,
        state=status.state,
        noise_db=record.noise_db,
        endangered=status.endangered_links,
        scans_m=tuple(scans),
    )


def victim_shapes(
    victims: Sequence[Victim],
    states: Sequence[str],
    fallen: Collection[str] = frozenset(),
    enclosed: Collection[str] = frozenset(),
) -> tuple[VictimShape, ...]:
    """Return victims with their states. Args: fallen, enclosed: as `gait_now`."""
    return tuple(
        VictimShape(v.name, v.position, state, gait_now(v.name, gait_of(v), fallen, enclosed))
        for v, state in zip(victims, states, strict=True)
    )


def gait_of(victim: Victim) -> Gait:
    """Return how a victim moves at the start."""
    if victim.flees:
        return "flees"
    return "walks" if victim.can_walk or victim.walks else "lies"


def gait_now(name: str, gait: Gait, fallen: Collection[str], enclosed: Collection[str]) -> Gait:
    """Return how a victim moves who moved otherwise at the start.

    Args: fallen: names of those who have collapsed.  enclosed: of those who wait, for no path to an
          exit is open.
    """
    if name in fallen:
        return "lies"
    return "walks" if gait == "flees" and name in enclosed else gait


def fallen_of(events: Iterable[AnyEvent]) -> frozenset[str]:
    """Return the names of the victims who collapse in these events."""
    return frozenset(event.subject for event in events if event.kind == "victim_collapsed")


class MovingPerson(Protocol):
    """A person of the world, or of a message on /world/people."""

    @property
    def name(self) -> str:
        """That of the victim."""

    @property
    def motion(self) -> str:
        """As in `PersonState`."""


def enclosed_of(people: Iterable[MovingPerson]) -> frozenset[str]:
    """Return the names of the people for whom no path to an exit is open."""
    return frozenset(person.name for person in people if person.motion == "enclosed")


def finite_ranges(ranges_m: np.ndarray, far_m: float) -> list[float]:
    """Return ranges in which inf, no return, is `far_m` [m], and -inf, too near, is 0."""
    ranges: list[float] = np.nan_to_num(ranges_m, nan=far_m, posinf=far_m, neginf=0.0).tolist()
    return ranges


def links_of(adjacency: np.ndarray, rssi_dbm: np.ndarray | None) -> tuple[Link, ...]:
    """Return the links of a network. Args: bool and float64, shape (n, n); None: the signals are unknown."""
    first, second = np.nonzero(np.triu(adjacency, 1))
    signals = np.full(len(first), UNKNOWN_SIGNAL_DBM) if rssi_dbm is None else np.rint(rssi_dbm[first, second])
    return tuple(zip(first.tolist(), second.tolist(), signals.astype(int).tolist(), strict=True))


def shown_events(events: Sequence[AnyEvent], time_s: float) -> list[ShownEvent]:
    """Return events of the step at a time [s]."""
    return [ShownEvent(time_s, event.kind, event.detail) for event in events]
