"""A frame: everything that a viewer shows of one moment of a mission."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, Literal

import msgspec
import numpy as np

from robotteamsim.interface import OUTSIDE, Localisation
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.events import AnyEvent
from robotteamsim.scenario.sections import Victim
from robotteamsim.scenario.sensors import Sensor
from robotteamsim.scenario.sensors.base import text_of
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord
from robotteamsim.world.contract import ObjectStates
from robotteamsim.world.people import PersonState

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
    """A victim: where they are [m], their state (`fleeing` if they flee and are not found), and how they move."""

    name: str
    position_m: tuple[float, float]
    state: str
    gait: Gait = "lies"


class ShownEgress(msgspec.Struct, frozen=True):
    """How people leave, as of a frame; times are of the mission's clock, or from ignition, as in `Egress` [s].

    out:       how many people are safe, by exit.
    exposures: of each victim, the doses by gas and by heat, and how far they see [m]; empty before a fire.
    """

    ignition_s: float | None
    aset_s: float | None
    rset_s: float | None
    out: dict[str, int]
    exposures: tuple[tuple[float, float, float], ...]


class ShownEvent(msgspec.Struct, frozen=True):
    """An event with the time of the frame in which it is shown [s]."""

    time_s: float
    kind: str
    text: str


class Belief(msgspec.Struct, frozen=True):
    """Where a robot believes that it is: the state of its localisation, and its estimates, the best one first."""

    state: str
    poses: tuple[Pose, ...]


class Frame(msgspec.Struct, frozen=True):
    """One moment of a mission.

    time_s:  of the mission's clock, see `StepRecord`; in a bag, since the start of the mission [s].
    poses:   of each robot; None: it is absent.
    swarms:  of each robot; -1: it is excluded.
    links:   that exist.
    doors:   opening of each door, 0 closed .. 1 open.
    objects: pose of each object of the scene; None: it is not there.
    explored, target: whether each area is explored; the area to explore now, -1 for none.
    endangered: how often a link became endangered so far.
    scans_m: ranges of each robot's laser; empty in frames without scans.
    egress:  None without fire and without exits.
    sensors: the last readings of each robot's `robots.sensors` in words, by their names; () as for `scans_m`.
    beliefs: of each robot, () if none localises itself.
    """

    time_s: float
    poses: tuple[Pose | None, ...]
    swarms: tuple[int, ...] = ()
    links: tuple[Link, ...] = ()
    fiedler_value: float = 0.0
    doors: tuple[float, ...] = ()
    objects: tuple[Pose | None, ...] = ()
    victims: tuple[VictimShape, ...] = ()
    explored: tuple[bool, ...] = ()
    target: int = -1
    state: str = ""
    noise_db: float = 0.0
    endangered: int = 0
    scans_m: tuple[list[float], ...] = ()
    egress: ShownEgress | None = None
    sensors: tuple[dict[str, str], ...] = ()
    beliefs: tuple[Belief | None, ...] = ()


def frame_of(
    record: StepRecord,
    setup: Setup,
    *,
    with_scans: bool,
    fallen: Collection[str] = frozenset(),
    sensors: tuple[dict[str, str], ...] = (),
) -> Frame:
    """Return the frame of a step. Args: fallen: names of the victims who have collapsed.  sensors: as in `Frame`."""
    scans = [finite_ranges(reading.ranges_m, FAR_M) for reading in record.readings] if with_scans else []
    team = zip(record.readings, record.present, strict=True)
    poses = [reading.true_pose if is_there else None for reading, is_there in team]
    status, enclosed = record.mission, enclosed_of(record.people)
    return Frame(
        time_s=status.time_s,
        poses=tuple(None if pose is None else (pose.x_m, pose.y_m, pose.yaw_rad) for pose in poses),
        swarms=tuple(OUTSIDE if decision.excluded else decision.swarm for decision in record.decisions),
        links=links_of(record.network.adjacency, record.network.rssi_dbm),
        fiedler_value=record.network.fiedler_value,
        doors=tuple(state.opening for state in record.doors.values()),
        objects=shown_objects((obj.name for obj in setup.scenario.objects), record.objects),
        victims=tuple(
            victim_shape(victim.name, victim.position, state, gait_of(victim), fallen, enclosed)
            for victim, state in zip(record.victims, status.victims, strict=True)
        ),
        explored=status.explored,
        target=status.target_area,
        state=status.state,
        noise_db=record.noise_db,
        endangered=status.endangered_links,
        scans_m=tuple(scans) if any(scans) else (),
        egress=shown_egress(record.egress),
        sensors=sensors,
        beliefs=shown_beliefs(decision.localisation for decision in record.decisions),
    )


def shown_beliefs(localisations: Iterable[Localisation | None]) -> tuple[Belief | None, ...]:
    """Return what robots believe, as shown."""
    beliefs: list[Belief | None] = []
    for one in localisations:
        poses = () if one is None else tuple((e.pose.x_m, e.pose.y_m, e.pose.yaw_rad) for e in one.estimates)
        beliefs.append(None if one is None else Belief(one.state, poses))
    return tuple(beliefs) if any(beliefs) else ()


def sensor_texts(robot_id: int, sensors: Iterable[Sensor], readings: Mapping[str, Any]) -> dict[str, str]:
    """Return the readings of a robot's sensors in words, by the sensors' names. Raises: SensorError."""
    known = (sensor for sensor in sensors if sensor.name in readings)
    texts = ((sensor.name, text_of(sensor, robot_id, readings[sensor.name])) for sensor in known)
    return {name: text for name, text in texts if text}


def shown_objects(names: Iterable[str], now: ObjectStates) -> tuple[Pose | None, ...]:
    """Return the poses of objects. Args: names: of those in the scene."""
    poses = {obj.name: (at.x_m, at.y_m, at.yaw_rad) for obj, at in zip(*now, strict=True)}
    return tuple(map(poses.get, names))


def shown_egress(egress: Egress | None) -> ShownEgress | None:
    """Return the egress of a mission as shown."""
    if egress is None:
        return None
    exposures = tuple((person.gas, person.heat, person.visibility_m) for person in egress.people)
    is_lit = egress.ignition_s is not None
    return ShownEgress(egress.ignition_s, egress.aset_s, egress.rset_s, egress.num_out, exposures if is_lit else ())


def victim_shape(
    name: str,
    position_m: tuple[float, float],
    state: str,
    gait: Gait,
    fallen: Collection[str],
    enclosed: Collection[str],
) -> VictimShape:
    """Return a victim as shown.

    Args: gait: at the start.  fallen: names of those who have collapsed.  enclosed: of those who wait,
          for no path to an exit is open.
    """
    if name in fallen:
        gait = "lies"
    elif gait == "flees" and name in enclosed:
        gait = "walks"
    is_fleeing = gait == "flees" and state in ("waiting", "heard")
    return VictimShape(name, position_m, "fleeing" if is_fleeing else state, gait)


def gait_of(victim: Victim) -> Gait:
    """Return how a victim moves at the start."""
    if victim.flees:
        return "flees"
    return "walks" if victim.can_walk or victim.walks else "lies"


def fallen_of(events: Iterable[AnyEvent]) -> frozenset[str]:
    """Return the names of the victims who collapse in these events."""
    return frozenset(event.subject for event in events if event.kind == "victim_collapsed")


def enclosed_of(people: Iterable[PersonState]) -> frozenset[str]:
    """Return the names of the people for whom no path to an exit is open."""
    return frozenset(person.name for person in people if person.motion == "enclosed")


def finite_ranges(ranges_m: np.ndarray, far_m: float) -> list[float]:
    """Return ranges to 5 cm, in which inf, no return, is `far_m` [m], and -inf, too near, is 0."""
    known_m = np.nan_to_num(np.asarray(ranges_m, dtype=np.float64), nan=far_m, posinf=far_m, neginf=0.0)
    ranges: list[float] = (np.rint(20.0 * known_m) / 20.0).tolist()
    return ranges


def links_of(adjacency: np.ndarray, rssi_dbm: np.ndarray | None) -> tuple[Link, ...]:
    """Return the links of a network. Args: bool and float64, shape (n, n); None: the signals are unknown."""
    first, second = np.nonzero(np.triu(adjacency, 1))
    signals = np.full(len(first), UNKNOWN_SIGNAL_DBM) if rssi_dbm is None else np.rint(rssi_dbm[first, second])
    return tuple(zip(first.tolist(), second.tolist(), signals.astype(int).tolist(), strict=True))


def shown_events(events: Sequence[AnyEvent], time_s: float) -> list[ShownEvent]:
    """Return events of the step at a time [s]."""
    return [ShownEvent(time_s, event.kind, event.detail) for event in events]
