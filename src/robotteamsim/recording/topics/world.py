"""The topics of the world: time, map, doors, who is present, objects, people, fire and smoke."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import msgspec
import numpy as np

from robotteamsim import palette
from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.hazards import BURNING, BURNT_OUT, HazardField
from robotteamsim.hazards.field import FARTHEST_SIGHT_M
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, level_frames, point
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics.base import (
    Source,
    Topic,
    When,
    check_finite,
    check_place,
    field_map,
    occupancy_grid,
    read_field_map,
    read_occupancy_grid,
    read_point,
)
from robotteamsim.recording.topics.markers import ADD, CUBE, CYLINDER, DELETE_ALL, Marker, array_message
from robotteamsim.scenario.levels import Level
from robotteamsim.scenario.map_image import published_map
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import OccupancyGrid, level_grid
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.scenario import Role, Scenario
from robotteamsim.world.contract import Mishap, ObjectStates
from robotteamsim.world.doors import DoorState, DoorStates
from robotteamsim.world.people import PersonState

MISHAPS: tuple[Mishap | None, ...] = (None, "tipped_over", "left_world")
"""Each value of `mishaps` in robotteamsim/Robots."""
ROLES: tuple[Role, ...] = ("robot", "firefighter", "command_centre")
"""Each value of `roles` in robotteamsim/Robots."""
BURNING_VALUE, BURNT_OUT_VALUE = 100, 50
"""Values of cells in /fire/grid; others are 0."""
_OBJECTS = "objects"
"""Namespace of the markers in /world/objects."""


class TeamPresence(msgspec.Struct, frozen=True):
    """Which members of a team are present, how often each has arrived, and what they are, by id."""

    present: tuple[bool, ...]
    arrivals: tuple[int, ...]
    roles: tuple[Role, ...] = ()


def clock(time_ns: int) -> RosMessage:
    """rosgraph_msgs/Clock."""
    return {"clock": time_ns}


def level_transforms(time_ns: int, levels: Sequence[Level]) -> RosMessage:
    """tf2_msgs/TFMessage: map -> each level, at its origin, so that points above each other have equal coordinates."""
    frames = level_frames([level.name for level in levels])
    return {
        "transforms": [
            {
                "header": header(time_ns, MAP_FRAME),
                "child_frame_id": frame,
                "transform": {"translation": point(level.origin), "rotation": {"w": 1.0}},
            }
            for level, frame in zip(levels, frames, strict=True)
        ]
    }


def level_maps(scenario: Scenario) -> list[Topic]:
    """Return the topics of the maps of a scenario's levels, /<level>/map."""
    levels = scenario.plan.levels
    return [_level_map(*one) for one in zip(levels, level_frames([level.name for level in levels]), strict=True)]


def _level_map(level: Level, frame: str) -> Topic:
    def values(source: Source, _: Any) -> tuple[OccupancyGrid, str]:
        scenario = source.setup.scenario
        return level_grid(scenario.plan, level, scenario.run.map_resolution_m), frame

    name, type_name = f"/{frame}/map", "nav_msgs/OccupancyGrid"
    return Topic(name, type_name, When.ONCE, values, occupancy_grid, latched=True, version=lambda _: 0)


def doors(time_ns: int, states: DoorStates) -> RosMessage:
    """robotteamsim/Doors."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "doors": [
            {"name": name, "closed": door.closed, "opening": door.opening, "motion": door.motion}
            for name, door in states.items()
        ],
    }


def read_doors(message: Any) -> DoorStates:
    """Return the state of each door. Leaves of other worlds may overshoot; without a number, they are at rest."""
    states = {}
    for door in message.doors:
        opening = min(max(door.opening, 0.0), 1.0) if math.isfinite(door.opening) else float(not door.closed)
        states[door.name] = DoorState(bool(door.closed), opening, door.motion)
    return DoorStates(states)


def people(time_ns: int, states: Sequence[PersonState]) -> RosMessage:
    """robotteamsim/People."""
    return {
        "header": header(time_ns, MAP_FRAME),
        "people": [{"name": one.name, "position": point(one.position_m), "motion": one.motion} for one in states],
    }


def read_people(message: Any) -> tuple[PersonState, ...]:
    """Return the people. Raises: ValueError: an impossible place."""
    return tuple(PersonState(one.name, read_point("position", one.position), one.motion) for one in message.people)


def robots(
    time_ns: int,
    present: np.ndarray,
    arrivals: Sequence[int],
    mishaps: Mapping[int, Mishap] = MappingProxyType({}),
    failed: Collection[int] = (),
    loads: Mapping[int, str] = MappingProxyType({}),
    roles: Sequence[Role] = (),
) -> RosMessage:
    """robotteamsim/Robots.

    Args: present: bool, shape (n,).  mishaps, loads: by id.  roles: in id order.
    """
    numbers = [MISHAPS.index(mishaps.get(robot_id)) for robot_id in range(len(arrivals))] if mishaps else []
    return {
        "header": header(time_ns, MAP_FRAME),
        "present": present,
        "mishaps": numbers,
        "arrivals": arrivals,
        "failed_by_heat": [robot_id in failed for robot_id in range(len(arrivals))],
        "roles": [ROLES.index(role) for role in roles],
        "loads": [loads.get(robot_id, "") for robot_id in range(len(arrivals))] if loads else [],
    }


def read_robots(message: Any, num_robots: int | None = None) -> TeamPresence:
    """Return which robots are present. Args: num_robots: that are expected; None: any number.

    Raises: ValueError: another number of robots, or an unknown role.
    """
    for name in ("present", "arrivals"):
        count = len(getattr(message, name))
        if num_robots not in (None, count):
            raise ValueError(f"{name}: {count} entries; expected {num_robots}")
    if len(message.roles) and max(message.roles) >= len(ROLES):
        raise ValueError(f"role {max(message.roles)}; expected at most {len(ROLES) - 1}")
    roles = tuple(ROLES[number] for number in message.roles)
    return TeamPresence(tuple(map(bool, message.present)), tuple(map(int, message.arrivals)), roles)


def objects(_: int, states: ObjectStates, *, replace: bool = False) -> RosMessage:
    """visualization_msgs/MarkerArray: one marker per object, with its index as id and its name as text.

    Args: replace: first delete all other markers.
    """
    markers = [_object_marker(i, obj, at) for i, (obj, at) in enumerate(zip(*states, strict=True))]
    clearing = [Marker(_OBJECTS, 0, CUBE, (1.0, 1.0, 1.0, 1.0), action=DELETE_ALL)] if replace else []
    return array_message([*clearing, *markers])


def _object_marker(marker_id: int, obj: MovableObject, at: Pose) -> Marker:
    kind, colour = (CUBE, palette.BOX) if obj.size_m else (CYLINDER, palette.BARREL)
    length_m, width_m = obj.size_m or (2.0 * obj.reach_m, 2.0 * obj.reach_m)
    place, scale = (at.x_m, at.y_m, 0.5 * obj.height_m), (length_m, width_m, obj.height_m)
    return Marker(_OBJECTS, marker_id, kind, (*palette.rgb(colour), 1.0), place, at.yaw_rad, scale, text=obj.name)


def read_objects(message: Any) -> ObjectStates:
    """Return the objects of /world/objects, without mass and friction, and without markers of other programs.

    Raises: ValueError: impossible ones.
    """
    models, poses = [], []
    for marker in message.markers:
        if marker.ns != _OBJECTS or marker.action != ADD or marker.type not in (CUBE, CYLINDER):
            continue
        place, turn, size = marker.pose.position, marker.pose.orientation, marker.scale
        check_place("object", place.x, place.y)
        check_finite("orientation of an object", turn.z, turn.w)
        at = PoseReading(place.x, place.y, turn.z, turn.w).pose
        is_box, numbers = marker.type == CUBE, {"height_m": size.z, "pose": msgspec.structs.astuple(at)}
        shape = {"kind": "box", "size_m": (size.x, size.y)} if is_box else {"kind": "barrel", "radius_m": 0.5 * size.x}
        models.append(checked(MovableObject, {"name": marker.text, **shape, **numbers}, ValueError))
        poses.append(at)
    return ObjectStates(tuple(models), tuple(poses))


def fire_cells(field: HazardField) -> np.ndarray:
    """Return the cells of /fire/grid, int8, shape (rows, cols)."""
    cells = np.zeros(field.states.shape, dtype=np.int8)
    cells[field.states == BURNING] = BURNING_VALUE
    cells[field.states == BURNT_OUT] = BURNT_OUT_VALUE
    return cells


def smoke_cells(field: HazardField) -> np.ndarray:
    """Return the cells of /smoke/grid, int8, shape (rows, cols): 0 for a visibility of 30 m, 100 for none."""
    soot = field.fire.soot
    extinction_per_m = np.maximum(soot.extinction_m2_g * field.soot_g_m3, soot.visibility_c / FARTHEST_SIGHT_M)
    visibility_m = soot.visibility_c / extinction_per_m
    return np.round(100.0 * (1.0 - visibility_m / FARTHEST_SIGHT_M)).astype(np.int8)


def _hazards(
    name: str, type_name: str, message: Callable[[int, HazardField], Any], read: Callable[[Any], Any]
) -> Topic:
    return Topic(
        name,
        type_name,
        When.FIRE,
        lambda _, record: None if record.hazards is None else (record.hazards,),
        message,
        latched=True,
        is_in=lambda scenario: scenario.fire is not None,
        read=lambda message, *_: read(message),
    )


def _hazard_grid(name: str, cells: Callable[[HazardField], np.ndarray]) -> Topic:
    def message(time_ns: int, field: HazardField) -> RosMessage:
        return occupancy_grid(time_ns, OccupancyGrid(field.origin_m, field.resolution_m, cells(field)))

    return _hazards(name, "nav_msgs/OccupancyGrid", message, read_occupancy_grid)


def _hazard_map(name: str, values: Callable[[HazardField], np.ndarray], quantity: str, unit: str) -> Topic:
    def message(time_ns: int, field: HazardField) -> RosMessage:
        numbers = FieldMap(field.origin_m, field.resolution_m, values(field))
        return field_map(time_ns, numbers, quantity, unit)

    return _hazards(name, "robotteamsim/FloatMap", message, read_field_map)


CLOCK = Topic("/clock", "rosgraph_msgs/Clock", When.CLOCK, lambda *_: (), clock, latched=True)
MAP = Topic(
    "/map",
    "nav_msgs/OccupancyGrid",
    When.ONCE,
    lambda source, _: (published_map(source.setup.scenario),),
    occupancy_grid,
    latched=True,
    version=lambda _: 0,
    read=lambda message, *_: read_occupancy_grid(message),
)
LEVEL_FRAMES = Topic(
    "/tf_static",
    "tf2_msgs/TFMessage",
    When.ONCE,
    lambda source, _: (source.setup.plan.levels,),
    level_transforms,
    latched=True,
    version=lambda _: 0,
    is_in=lambda scenario: bool(scenario.plan.levels),
)
DOORS = Topic(
    "/world/doors",
    "robotteamsim/Doors",
    When.STEP,
    lambda _, record: (record.doors,) if record.doors else None,
    doors,
    latched=True,
    version=lambda record: record.doors.version,
    read=lambda message, *_: read_doors(message),
)
ROBOTS = Topic(
    "/world/robots",
    "robotteamsim/Robots",
    When.STEP,
    lambda source, record: (
        *(record.present, record.arrivals, record.mishaps, record.failed, record.loads),
        source.setup.scenario.roles,
    ),
    robots,
    latched=True,
    version=lambda record: record.team_version,
    read=lambda message, setup, _: read_robots(message, setup and setup.scenario.team_size),
)
OBJECTS = Topic(
    "/world/objects",
    "visualization_msgs/MarkerArray",
    When.CHANGE,
    lambda source, record: (record.objects, source.objects.replace(record.objects.models)),
    lambda time_ns, states, replace: objects(time_ns, states, replace=replace),
    latched=True,
    version=lambda record: record.objects,
    read=lambda message, *_: read_objects(message),
)
PEOPLE = Topic(
    "/world/people",
    "robotteamsim/People",
    When.STEP,
    lambda _, record: (record.people,) if record.people else None,
    people,
    latched=True,
    version=lambda record: record.people_version,
    is_in=lambda scenario: scenario.moves_people,
    read=lambda message, *_: read_people(message),
)
FIRE = _hazard_grid("/fire/grid", fire_cells)
TEMPERATURE = _hazard_map("/fire/temperature", lambda field: field.temperatures_c, "temperature", "degC")
SMOKE = _hazard_grid("/smoke/grid", smoke_cells)
SOOT = _hazard_map("/smoke/soot", lambda field: field.soot_g_m3, "soot", "g/m^3")
WORLD_TOPICS = (DOORS, OBJECTS, PEOPLE, FIRE, TEMPERATURE, SMOKE, SOOT)
"""Topics of the record that need no mission. Time, map, presence and tf have a time of their own in a step."""
