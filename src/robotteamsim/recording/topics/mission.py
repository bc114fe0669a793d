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
from robotteamsim.mission.status import DeliveredDiscoveries, MissionStatus, VictimState
from robotteamsim.recording.topics.base import Topic, When, read_point
from robotteamsim.scenario.sections import LARGEST_AREA_M, Area, Victim
from robotteamsim.setup import Setup

_NOTHING_DELIVERED = DeliveredDiscoveries()


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


def read_task(message: Any, num_robots: int) -> Task:
    """Return the task of the team in a MissionStatus. Raises: ValueError: unknown ids, or impossible places."""
    for one in message.assistance:
        if not 0 <= one.robot_id < num_robots:
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


def mission_event(time_ns: int, event: Event) -> RosMessage:
    """robotteamsim/MissionEvent."""
    return {
        "header": header(time_ns, MAP_FRAME),
        **event.row(),
        "error_m": event.what.error_m if isinstance(event.what, VictimLocated) else 0.0,
    }


def victims(time_ns: int, all_victims: Sequence[Victim], states: Sequence[VictimState]) -> RosMessage:
    """robotteamsim/Victims."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "victims": [
            {"name": victim.name, "position": point(victim.position), "state": state}
            for victim, state in zip(all_victims, states, strict=True)
        ],
    }


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
    """Return the egress of a message."""
    return Egress(
        ignition_s=_or_none(message.ignition_s),
        people=tuple(_read_part(PersonEgress, person) for person in message.people),
        exits=tuple(_read_part(ExitEgress, way_out) for way_out in message.exits),
    )


def _read_part(kind: Any, message: Any) -> Any:
    return kind(**{key: _or_none(getattr(message, key)) for key in kind.__struct_fields__})


def _or_none(value: Any) -> Any:
    return None if isinstance(value, float) and math.isnan(value) else value


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
    read=lambda message, setup, _: read_task(message, setup.scenario.team_size),
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
)
MISSION_TOPICS = (
    MISSION_STATUS,
    Topic(
        "/mission/events",
        "robotteamsim/MissionEvent",
        When.EVENT,
        lambda _, record: [(event,) for event in record.events],
        mission_event,
        several=True,
    ),
    Topic(
        "/mission/victims",
        "robotteamsim/Victims",
        When.CHANGE,
        lambda _, record: (record.victims, record.mission.victims),
        victims,
        latched=True,
        version=lambda record: (record.victims, record.mission.victims),
    ),
    EGRESS,
    Topic(
        "/mission/areas",
        "robotteamsim/Areas",
        When.CHANGE,
        lambda source, record: (source.setup.scenario.mission.areas, record.mission),
        areas,
        latched=True,
        version=lambda record: (record.mission.explored, record.mission.target_area),
    ),
)
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
