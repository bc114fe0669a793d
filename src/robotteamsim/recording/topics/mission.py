"""The topics of the mission."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from robotteamsim.interface import Assistance, Decision, Discovery, Task
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, point
from robotteamsim.mission.egress import Egress, ExitEgress, PersonEgress
from robotteamsim.mission.events import Event, VictimLocated
from robotteamsim.mission.status import SAVED, DeliveredDiscoveries, MissionStatus, VictimState
from robotteamsim.recording.topics.base import FARTHEST_M, LONGEST_S, Topic, When, check_within, read_point
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.sections import LARGEST_AREA_M, Area, Victim
from robotteamsim.setup import Setup

_NOTHING_DELIVERED = DeliveredDiscoveries()


class PublishedStatus(msgspec.Struct, frozen=True):
    """The mission, as /mission/status has it; see `MissionStatus`."""

    time_s: float = 0.0
    scenario: str = ""
    state: str = ""
    end: str = ""
    explored: tuple[bool, ...] = ()
    victims: tuple[str, ...] = ()
    endangered_links: int = 0
    noise_db: float = 0.0
    delivered: DeliveredDiscoveries | None = None
    target_area: int = -1

    @property
    def num_saved(self) -> int:
        """Number of victims who are saved or safe."""
        return sum(state in SAVED for state in self.victims)

    @property
    def num_heard(self) -> int:
        """Number of victims who have been heard or found."""
        return sum(state != "waiting" for state in self.victims)


class PublishedVictim(msgspec.Struct, frozen=True):
    """A victim, in `map` [m]; state: see `mission.status.VictimState`."""

    name: str
    position_m: Point
    state: str


class PublishedArea(msgspec.Struct, frozen=True):
    """An area, in `map` [m]: whether it is explored, and whether the team is to explore it now."""

    name: str
    center_m: Point
    radius_m: float
    explored: bool
    is_target: bool


class PublishedEvent(msgspec.Struct, frozen=True):
    """An event of the mission: see `mission.events.Event`. error_m: of the event `victim_located` [m]."""

    time_s: float
    kind: str
    subject: str
    robot_id: int
    detail: str
    error_m: float = 0.0

    def row(self) -> dict[str, Any]:
        """Return what every event has, by key."""
        return {key: value for key, value in msgspec.structs.asdict(self).items() if key != "error_m"}


def mission_status(time_ns: int, scenario_name: str, status: MissionStatus, noise_db: float) -> RosMessage:
    """robotteamsim/MissionStatus."""
    task, delivered = status.task, status.delivered or _NOTHING_DELIVERED
    return {
        "header": header(time_ns, MAP_FRAME),
        "scenario": scenario_name,
        "state": status.state,
        "end": status.end,
        "time_s": status.time_s,
        "explored": status.explored,
        "victims": status.victims,
        "target_area": status.target_area,
        "endangered_links": status.endangered_links,
        "noise_db": noise_db,
        "running": task.running,
        "epoch": task.epoch,
        "has_area": task.area_center_m is not None,
        "area_center": point(task.area_center_m or (0.0, 0.0)),
        "area_radius_m": task.area_radius_m,
        "explored_by": task.explored_by,
        "has_base": status.delivered is not None,
        "discoveries_delivered": delivered.count,
        "mean_delivery_delay_s": delivered.mean_delay_s,
        "max_delivery_delay_s": delivered.max_delay_s,
        "undelivered": [_discovery(discovery) for discovery in task.undelivered],
        "assistance": [msgspec.structs.asdict(assistance) for assistance in task.assistance],
    }


def _discovery(discovery: Discovery) -> RosMessage:
    return {
        "kind": discovery.kind,
        "name": discovery.name,
        "robot_id": discovery.robot_id,
        "position": point(discovery.position_m),
        "time_s": discovery.time_s,
    }


def read_task(message: Any, num_robots: int | None) -> Task:
    """Return the task of the team in a MissionStatus. Raises: ValueError: unknown ids, or impossible places."""
    for one in message.assistance:
        if num_robots is not None and not 0 <= one.robot_id < num_robots:
            raise ValueError(f"assistance: robot {one.robot_id}; expected the id of a firefighter")
    if not 0.0 <= message.area_radius_m <= LARGEST_AREA_M:
        raise ValueError(f"area_radius_m: {message.area_radius_m:g}; expected 0 to {LARGEST_AREA_M:g} m")
    return Task(
        running=message.running,
        epoch=message.epoch,
        area_center_m=read_point("area_center", message.area_center) if message.has_area else None,
        area_radius_m=message.area_radius_m,
        undelivered=tuple(
            Discovery(find.kind, find.name, find.robot_id, read_point("undelivered", find.position), find.time_s)
            for find in message.undelivered
        ),
        assistance=tuple(Assistance(one.robot_id, one.victim, one.moving, one.collapsed) for one in message.assistance),
        explored_by=tuple(map(int, message.explored_by)),
    )


def read_status(message: Any) -> PublishedStatus:
    """Return the mission of a MissionStatus, without the team's task. Raises: ValueError: an impossible time."""
    delivered = None
    if message.has_base:
        count = int(message.discoveries_delivered)
        delivered = DeliveredDiscoveries(count, message.mean_delivery_delay_s, message.max_delivery_delay_s)
    return PublishedStatus(
        time_s=check_within("time", message.time_s, LONGEST_S),
        scenario=message.scenario,
        state=message.state,
        end=message.end,
        explored=tuple(map(bool, message.explored)),
        victims=tuple(message.victims),
        endangered_links=int(message.endangered_links),
        noise_db=message.noise_db,
        delivered=delivered,
        target_area=int(message.target_area),
    )


def mission_event(time_ns: int, event: Event) -> RosMessage:
    """robotteamsim/MissionEvent."""
    return {
        "header": header(time_ns, MAP_FRAME),
        **event.row(),
        "error_m": event.what.error_m if isinstance(event.what, VictimLocated) else 0.0,
    }


def read_event(message: Any) -> PublishedEvent:
    """Return an event. Raises: ValueError: an impossible time."""
    time_s = check_within("time", message.time_s, LONGEST_S)
    return PublishedEvent(time_s, message.kind, message.subject, message.robot_id, message.detail, message.error_m)


def victims(time_ns: int, all_victims: Sequence[Victim], states: Sequence[VictimState]) -> RosMessage:
    """robotteamsim/Victims."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "victims": [
            {"name": victim.name, "position": point(victim.position), "state": state}
            for victim, state in zip(all_victims, states, strict=True)
        ],
    }


def read_victims(message: Any) -> tuple[PublishedVictim, ...]:
    """Return the victims. Raises: ValueError: an impossible place."""
    return tuple(PublishedVictim(one.name, read_point("position", one.position), one.state) for one in message.victims)


def areas(time_ns: int, all_areas: Sequence[Area], status: MissionStatus) -> RosMessage:
    """robotteamsim/Areas."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "areas": [
            {
                "name": area.name,
                "center": point(area.center),
                "radius_m": area.radius_m,
                "explored": status.explored[index],
                "target": index == status.target_area,
            }
            for index, area in enumerate(all_areas)
        ],
    }


def read_areas(message: Any) -> tuple[PublishedArea, ...]:
    """Return the areas. Raises: ValueError: an impossible place or radius."""
    return tuple(
        PublishedArea(
            name=one.name,
            center_m=read_point("center", one.center),
            radius_m=check_within("radius", one.radius_m, FARTHEST_M),
            explored=bool(one.explored),
            is_target=bool(one.target),
        )
        for one in message.areas
    )


def egress(time_ns: int, state: Egress) -> RosMessage:
    """robotteamsim/Egress."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "ignition_s": _or_nan(state.ignition_s),
        "people": [_part(person) for person in state.people],
        "exits": [_part(way_out) for way_out in state.exits],
    }


def _part(part: PersonEgress | ExitEgress) -> RosMessage:
    return {key: _or_nan(value) for key, value in msgspec.structs.asdict(part).items()}


def _or_nan(value: Any) -> Any:
    return math.nan if value is None else value


def read_egress(message: Any) -> Egress:
    """Return the egress of a message. Raises: ValueError: impossible times, doses or distances."""
    return Egress(
        ignition_s=_or_none(message.ignition_s),
        people=tuple(_read_part(PersonEgress, person) for person in message.people),
        exits=tuple(_read_part(ExitEgress, way_out) for way_out in message.exits),
    )


def _read_part(kind: Any, message: Any) -> Any:
    for name in ("gas", "heat", "visibility_m"):
        check_within(name, getattr(message, name), LONGEST_S)
    return kind(**{key: _or_none(getattr(message, key)) for key in kind.__struct_fields__})


def _or_none(value: Any) -> Any:
    """Return a value of a message; NaN is None. Raises: ValueError: a time is impossible."""
    if not isinstance(value, float):
        return value
    return None if math.isnan(value) else check_within("time", value, LONGEST_S)


def sensor_world(
    time_ns: int,
    status: MissionStatus,
    setup: Setup,
    present: np.ndarray,
    positions_m: np.ndarray,
    decisions: Sequence[Decision],
    all_victims: Sequence[Victim],
) -> RosMessage:
    """robotteamsim/SensorWorld [dissertation, 5.3].

    Args: present: bool, shape (n,).  positions_m: true ones in `map`, shape (n, 2) [m].
    """
    areas_m = [area.center for area in setup.scenario.mission.areas]
    victims_m = np.array([victim.position for victim in all_victims], dtype=np.float64).reshape(-1, 2)
    robots = []
    offsets_m = positions_m[:, np.newaxis] - victims_m
    distances_m = np.hypot(offsets_m[..., 0], offsets_m[..., 1])
    for robot_id, position in enumerate(positions_m.tolist()):
        if not present[robot_id]:
            continue
        decision = decisions[robot_id]
        area = decision.area if 0 <= decision.area < len(areas_m) else status.target_area
        robots.append(
            {
                "robot_id": robot_id,
                "has_local_best": decision.local_best_m is not None,
                "local_best": point(decision.local_best_m or (0.0, 0.0)),
                "value": decision.local_best,
                "victim_distances_m": distances_m[robot_id],
                "area": area,
                "area_distance_m": math.nan if area < 0 else math.dist(areas_m[area], position),
            }
        )
    return {
        "header": header(time_ns, MAP_FRAME),
        "victims": [victim.name for victim in all_victims],
        "robots": robots,
    }


MISSION_STATUS = Topic(
    "/mission/status",
    "robotteamsim/MissionStatus",
    When.STEP,
    lambda source, record: (source.setup.scenario.name, record.mission, record.noise_db),
    mission_status,
    latched=True,
    read=lambda message, setup, _: read_task(message, setup and setup.scenario.team_size),
)
EGRESS = Topic(
    "/mission/egress",
    "robotteamsim/Egress",
    When.CHANGE,
    lambda _, record: None if record.egress is None else (record.egress,),
    egress,
    latched=True,
    version=lambda record: record.egress,
    is_in=lambda scenario: scenario.has_egress,
    read=lambda message, *_: read_egress(message),
)
EVENTS = Topic(
    "/mission/events",
    "robotteamsim/MissionEvent",
    When.EVENT,
    lambda _, record: [(event,) for event in record.events],
    mission_event,
    several=True,
    read=lambda message, *_: read_event(message),
)
VICTIMS = Topic(
    "/mission/victims",
    "robotteamsim/Victims",
    When.CHANGE,
    lambda _, record: (record.victims, record.mission.victims),
    victims,
    latched=True,
    version=lambda record: (record.victims, record.mission.victims),
    read=lambda message, *_: read_victims(message),
)
AREAS = Topic(
    "/mission/areas",
    "robotteamsim/Areas",
    When.CHANGE,
    lambda source, record: (source.setup.scenario.mission.areas, record.mission),
    areas,
    latched=True,
    version=lambda record: (record.mission.explored, record.mission.target_area),
    read=lambda message, *_: read_areas(message),
)
MISSION_TOPICS = (MISSION_STATUS, EVENTS, VICTIMS, EGRESS, AREAS)
SENSOR_WORLD = Topic(
    "/sensor_world",
    "robotteamsim/SensorWorld",
    When.STEP,
    lambda source, record: (
        *(record.mission, source.setup, record.present, record.state.positions_m),
        *(record.decisions, record.victims),
    ),
    sensor_world,
)
"""It has no message before the first step, in which nobody has decided anything."""
