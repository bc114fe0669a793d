"""Checks of what arrives on topics: finite numbers, and as many entries as the scenario has robots and doors.

Anybody can publish anything. A message that fails is ignored, with one warning per topic; the node goes on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, get_args

import numpy as np

from robotteamsim.mission.status import VictimState
from robotteamsim.msg import NetworkMessages
from robotteamsim.network.compact import row_bytes
from robotteamsim.recording.ros_messages import MISHAPS
from robotteamsim.ros.transport.serialization import deserialized
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.world.people import Motion

FARTHEST_M = 1e6
"""Limit of coordinates, as in the propagation models."""
FINEST_CELL_M = 0.01
BRIGHTEST_LX = 1e12
LARGEST_VALUE = 1e6
"""Limit of the values of maps, in their unit."""


def reader(message_class: Any, settings: Settings | None = None) -> Callable[[bytes], Any]:
    """Return what makes a message of bytes; it raises ValueError if the bytes or the numbers in them are wrong.

    Args: settings: the team and plan that messages must fit; None: any, as in a bag of another run.
    """
    return partial(_read, message_class, settings)


def outbox_reader(robot_id: int, settings: Settings) -> Callable[[bytes], Any]:
    """Return the reader of a robot's `network/tx`: it also raises ValueError for messages of other senders."""
    return partial(_read_outbox, robot_id, settings)


def check_place(name: str, *coordinates: float) -> None:
    """Raises: ValueError: a coordinate [m] is not finite or beyond 1000 km."""
    for coordinate in coordinates:
        if not abs(coordinate) <= FARTHEST_M:
            shown = ", ".join(f"{value:g}" for value in coordinates)
            raise ValueError(f"{name}: ({shown}); expected finite numbers within 1000 km")


def check_finite(name: str, *values: float) -> None:
    """Raises: ValueError: a number is not finite."""
    for value in values:
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value:g}; expected finite numbers")


def check_levels(level_db: float, local_best_level_db: float) -> None:
    """Raises: ValueError: a voice level [dB] is below 0, which means silence, or far too high."""
    _expect_within("level_db", level_db, 0.0, LARGEST_VALUE)
    _expect_within("local_best_level_db", local_best_level_db, 0.0, LARGEST_VALUE)


def _read_outbox(robot_id: int, settings: Settings, data: bytes) -> Any:
    message = _read(NetworkMessages, settings, data)
    for one in message.messages:
        if one.sender != robot_id:
            raise ValueError(f"a message from {one.sender}; expected only from {robot_id}")
    return message


def _read(message_class: Any, settings: Settings | None, data: bytes) -> Any:
    message = deserialized(message_class, data)
    check = _CHECKS.get(message_class._type)
    if check is not None:
        check(message, settings)
    return message


def _expect(name: str, count: int, expected: int) -> None:
    if count != expected:
        raise ValueError(f"{name}: {count} entries; expected {expected}")


def _expect_within(name: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        raise ValueError(f"{name}: {value:g}; expected {low:g} to {high:g}")


def _check_heat(message: Any, _: Settings | None) -> None:
    check_place("temperature_c", message.temperature_c)
    for place in message.hot:
        check_place("hot", place.x, place.y)


def _check_robots(message: Any, settings: Settings | None) -> None:
    _expect("arrivals", len(message.arrivals), settings.num_robots if settings else len(message.present))
    _expect("present", len(message.present), len(message.arrivals))
    if message.mishaps:
        _expect("mishaps", len(message.mishaps), len(message.arrivals))
        if max(message.mishaps) >= len(MISHAPS):
            raise ValueError(f"mishaps: {max(message.mishaps)}; expected 0 to {len(MISHAPS) - 1}")
    if message.loads:
        _expect("loads", len(message.loads), len(message.arrivals))
    if message.failed_by_heat:  # empty in a world without fire
        _expect("failed_by_heat", len(message.failed_by_heat), len(message.arrivals))


def _check_team(message: Any, settings: Settings | None) -> None:
    count = settings.num_robots if settings else len(message.in_contact)
    for name, length in (("poses", 4), ("twists", 3), ("in_contact", 1)):
        _expect(name, len(getattr(message, name)), length * count)
    poses, twists = np.reshape(message.poses, (count, 4)), np.reshape(message.twists, (count, 3))
    valid = np.isfinite(poses).all(axis=1) & np.isfinite(twists).all(axis=1)
    valid &= (np.abs(poses[:, :2]) <= FARTHEST_M).all(axis=1)
    for robot_id in np.flatnonzero(~valid):
        if not np.isnan(poses[robot_id]).all():  # as that of an absent robot
            raise ValueError(f"robot {robot_id}: expected finite numbers within 1000 km")


def _check_voices(message: Any, settings: Settings | None) -> None:
    count = settings.num_robots if settings else len(message.heard)
    for name, length in (("level_db", 1), ("heard", 1), ("local_best", 2), ("local_best_level_db", 1)):
        _expect(name, len(getattr(message, name)), length * count)
    for levels in zip(message.level_db, message.local_best_level_db, strict=True):
        check_levels(*levels)
    places = np.reshape(message.local_best, (count, 2))
    # The place of a robot that hears nobody is not used.
    heard = np.frombuffer(message.heard, np.uint8) > 0
    for robot_id in np.flatnonzero(heard & ~(np.abs(places) <= FARTHEST_M).all(axis=1)):
        check_place(f"robot {robot_id}: local_best", *places[robot_id])


def _check_network(message: Any, settings: Settings | None) -> None:
    _check_num_robots(message, settings)
    for name in ("rssi_dbm", "link", "adjacency", "hop_count", "break_matrix", "endangered"):
        _expect(name, len(getattr(message, name)), message.num_robots**2)
    _expect("refused_bytes", len(message.refused_bytes), len(message.refused_senders))
    check_finite("fiedler_value", message.fiedler_value)
    check_finite("mean_delay_s", message.mean_delay_s)


def _check_links(message: Any, settings: Settings | None) -> None:
    _check_num_robots(message, settings)
    count = message.num_robots
    _expect("present", len(message.present), count)
    for name in ("adjacency", "endangered"):
        _expect(name, len(getattr(message, name)), count * row_bytes(count))
    for name in ("weakened_first", "weakened_second"):
        ids = getattr(message, name)
        _expect(name, len(ids), len(message.weakened_rssi_dbm))
        if max(ids, default=0) >= count:
            raise ValueError(f"{name}: {max(ids)}; expected ids below {count}")
    _expect("refused_bytes", len(message.refused_bytes), len(message.refused_senders))


def _check_num_robots(message: Any, settings: Settings | None) -> None:
    if settings and message.num_robots != settings.num_robots:
        raise ValueError(f"num_robots: {message.num_robots}; expected {settings.num_robots}")


def _check_messages(message: Any, settings: Settings | None) -> None:
    if settings is None:
        return
    for one in message.messages:
        if not 0 <= one.sender < settings.num_robots or not -1 <= one.receiver < settings.num_robots:
            raise ValueError(f"a message from {one.sender} to {one.receiver}; expected ids below {settings.num_robots}")


def _check_doors(message: Any, settings: Settings | None) -> None:
    expected = sorted(door.name for door in settings.scenario.plan.doors) if settings else None
    if expected is not None and sorted(door.name for door in message.doors) != expected:
        raise ValueError(f"doors: the names differ from those of the plan, {', '.join(expected)}")
    for door in message.doors:
        _expect_within("opening", door.opening, 0.0, 1.0)
        if door.motion not in ("still", "opens", "closes", "held"):
            raise ValueError("motion: expected still, opens, closes or held")


def _check_voice(message: Any, _: Settings | None) -> None:
    check_levels(message.level_db, message.local_best_level_db)
    check_place("local_best", message.local_best.x, message.local_best.y)


def _check_mission(message: Any, settings: Settings | None) -> None:
    check_finite("time_s", message.time_s)
    check_place("area_center", message.area_center.x, message.area_center.y)
    check_finite("area_radius_m", message.area_radius_m)
    for discovery in message.undelivered:
        check_place("undelivered", discovery.position.x, discovery.position.y)
    for assistance in message.assistance:
        if assistance.robot_id < 0 or (settings and assistance.robot_id >= settings.num_robots):
            raise ValueError(f"assistance: robot {assistance.robot_id}; expected the id of a firefighter")


def _check_controller(message: Any, _: Settings | None) -> None:
    if message.has_goal:
        check_place("goal", message.goal.x, message.goal.y)


def _check_range(message: Any, _: Settings | None) -> None:
    if math.isnan(message.range):  # infinity is a valid range (REP-117)
        raise ValueError("range: nan; expected a number")


def _check_illuminance(message: Any, _: Settings | None) -> None:
    _expect_within("illuminance", message.illuminance, 0.0, BRIGHTEST_LX)


def _check_fix(message: Any, _: Settings | None) -> None:
    _expect_within("latitude", message.latitude, -90.0, 90.0)
    _expect_within("longitude", message.longitude, -180.0, 180.0)
    check_place("altitude", message.altitude)
    _expect_within("position_covariance", message.position_covariance[0], 0.0, FARTHEST_M)


def _check_odometry(message: Any, _: Settings | None) -> None:
    pose = message.pose.pose
    check_place("position", pose.position.x, pose.position.y)
    check_finite("orientation", pose.orientation.z, pose.orientation.w)


def _check_contact(message: Any, _: Settings | None) -> None:
    check_finite("angles_rad", *message.angles_rad)


def _check_scan(message: Any, _: Settings | None) -> None:
    check_place("angles", message.angle_min, message.angle_increment)


def _check_map(message: Any, _: Settings | None) -> None:
    _expect_within("resolution_m", message.resolution_m, FINEST_CELL_M, FARTHEST_M)
    check_place("origin", message.origin.x, message.origin.y)
    _check_cells(message.data, message.width, message.height)
    for value in message.data:
        _expect_within("data", value, -LARGEST_VALUE, LARGEST_VALUE)


def _check_grid(message: Any, _: Settings | None) -> None:
    info = message.info
    _expect_within("resolution", info.resolution, FINEST_CELL_M, FARTHEST_M)
    check_place("origin", info.origin.position.x, info.origin.position.y)
    _check_cells(message.data, info.width, info.height)


def _check_cells(data: Sequence[float], width: int, height: int) -> None:
    if not data:
        raise ValueError("data: 0 entries; expected at least one cell")
    _expect("data", len(data), width * height)


def _check_markers(message: Any, _: Settings | None) -> None:
    for marker in message.markers:
        check_place("position", marker.pose.position.x, marker.pose.position.y)
        for point in marker.points:
            check_place("points", point.x, point.y, point.z)


def _check_names(name: str, owners: Sequence[Any]) -> None:
    if len({owner.name for owner in owners}) < len(owners):
        raise ValueError(f"{name}: expected unique names")


def _check_areas(message: Any, _: Settings | None) -> None:
    _check_names("areas", message.areas)
    for area in message.areas:
        check_place("center", area.center.x, area.center.y)
        _expect_within("radius_m", area.radius_m, 0.0, FARTHEST_M)


def _check_victims(message: Any, _: Settings | None) -> None:
    _check_names("victims", message.victims)
    for victim in message.victims:
        check_place("position", victim.position.x, victim.position.y)
        if victim.state not in get_args(VictimState):
            raise ValueError(f"state: expected one of {', '.join(get_args(VictimState))}")


def _check_people(message: Any, _: Settings | None) -> None:
    _check_names("people", message.people)
    for person in message.people:
        check_place("position", person.position.x, person.position.y)
        if person.motion not in get_args(Motion):
            raise ValueError(f"motion: expected one of {', '.join(get_args(Motion))}")


_CHECKS: dict[str, Callable[[Any, Settings | None], None]] = {
    "robotteamsim/Robots": _check_robots,
    "robotteamsim/TeamState": _check_team,
    "robotteamsim/TeamVoices": _check_voices,
    "robotteamsim/NetworkState": _check_network,
    "robotteamsim/NetworkLinks": _check_links,
    "robotteamsim/NetworkMessages": _check_messages,
    "robotteamsim/Doors": _check_doors,
    "robotteamsim/Voice": _check_voice,
    "robotteamsim/MissionStatus": _check_mission,
    "robotteamsim/ControllerStatus": _check_controller,
    "robotteamsim/Contact": _check_contact,
    "robotteamsim/FloatMap": _check_map,
    "robotteamsim/Heat": _check_heat,
    "robotteamsim/Areas": _check_areas,
    "robotteamsim/Victims": _check_victims,
    "robotteamsim/People": _check_people,
    "nav_msgs/OccupancyGrid": _check_grid,
    "nav_msgs/Odometry": _check_odometry,
    "sensor_msgs/LaserScan": _check_scan,
    "sensor_msgs/NavSatFix": _check_fix,
    "sensor_msgs/Illuminance": _check_illuminance,
    "sensor_msgs/Range": _check_range,
    "visualization_msgs/MarkerArray": _check_markers,
}
