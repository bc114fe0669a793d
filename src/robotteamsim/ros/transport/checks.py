"""Checks of what arrives on topics: finite numbers, and as many entries as the scenario has robots and doors.

Anybody can publish anything. A message that fails is ignored, with one warning per topic; the node goes on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

from robotteamsim.network.compact import row_bytes
from robotteamsim.ros.transport.serialization import deserialized
from robotteamsim.ros.transport.settings import Settings

FARTHEST_M = 1e6
"""Limit of coordinates, as in the propagation models."""


def reader(message_class: Any, settings: Settings) -> Callable[[bytes], Any]:
    """Return what makes a message of bytes; it raises ValueError if the bytes or the numbers in them are wrong."""
    return partial(_read, message_class, settings)


def check_place(name: str, *coordinates: float) -> None:
    """Raises: ValueError: a coordinate [m] is not finite or beyond 1000 km."""
    if not all(abs(value) <= FARTHEST_M for value in coordinates):
        shown = ", ".join(f"{value:g}" for value in coordinates)
        raise ValueError(f"{name}: ({shown}); expected finite numbers within 1000 km")


def check_finite(name: str, *values: float) -> None:
    """Raises: ValueError: a number is not finite."""
    if not all(map(math.isfinite, values)):
        raise ValueError(f"{name}: {', '.join(f'{value:g}' for value in values)}; expected finite numbers")


def _read(message_class: Any, settings: Settings, data: bytes) -> Any:
    message = deserialized(message_class, data)
    check = _CHECKS.get(message_class._type)
    if check is not None:
        check(message, settings)
    return message


def _expect(name: str, count: int, expected: int) -> None:
    if count != expected:
        raise ValueError(f"{name}: {count} entries; expected {expected}")


def _check_robots(message: Any, settings: Settings) -> None:
    _expect("present", len(message.present), settings.num_robots)
    _expect("arrivals", len(message.arrivals), settings.num_robots)


def _check_network(message: Any, settings: Settings) -> None:
    _check_num_robots(message, settings)
    for name in ("rssi_dbm", "link", "adjacency", "hop_count", "break_matrix", "endangered"):
        _expect(name, len(getattr(message, name)), settings.num_robots**2)
    _expect("refused_bytes", len(message.refused_bytes), len(message.refused_senders))


def _check_links(message: Any, settings: Settings) -> None:
    _check_num_robots(message, settings)
    count = settings.num_robots
    _expect("present", len(message.present), count)
    for name in ("adjacency", "endangered"):
        _expect(name, len(getattr(message, name)), count * row_bytes(count))
    for name in ("weakened_first", "weakened_second"):
        ids = getattr(message, name)
        _expect(name, len(ids), len(message.weakened_rssi_dbm))
        if max(ids, default=0) >= count:
            raise ValueError(f"{name}: {max(ids)}; expected ids below {count}")
    _expect("refused_bytes", len(message.refused_bytes), len(message.refused_senders))


def _check_num_robots(message: Any, settings: Settings) -> None:
    if message.num_robots != settings.num_robots:
        raise ValueError(f"num_robots: {message.num_robots}; expected {settings.num_robots}")


def _check_messages(message: Any, settings: Settings) -> None:
    for one in message.messages:
        if not 0 <= one.sender < settings.num_robots or not -1 <= one.receiver < settings.num_robots:
            raise ValueError(f"a message from {one.sender} to {one.receiver}; expected ids below {settings.num_robots}")


def _check_doors(message: Any, settings: Settings) -> None:
    expected = sorted(door.name for door in settings.scenario.plan.doors)
    if sorted(door.name for door in message.doors) != expected:
        raise ValueError(f"doors: the names differ from those of the plan, {', '.join(expected)}")
    for door in message.doors:
        check_finite("opening", door.opening)
        if door.motion not in ("still", "opens", "closes", "held"):
            raise ValueError("motion: expected still, opens, closes or held")


def _check_voice(message: Any, _: Settings) -> None:
    check_finite("level_db", message.level_db, message.local_best_level_db)
    check_place("local_best", message.local_best.x, message.local_best.y)


def _check_mission(message: Any, _: Settings) -> None:
    check_finite("time_s", message.time_s)
    check_place("area_center", message.area_center.x, message.area_center.y)
    check_finite("area_radius_m", message.area_radius_m)
    for discovery in message.undelivered:
        check_place("undelivered", discovery.position.x, discovery.position.y)


def _check_controller(message: Any, _: Settings) -> None:
    if message.has_goal:
        check_place("goal", message.goal.x, message.goal.y)


def _check_range(message: Any, _: Settings) -> None:
    if math.isnan(message.range):  # infinity is a valid range (REP-117)
        raise ValueError("range: nan; expected a number")


_CHECKS: dict[str, Callable[[Any, Settings], None]] = {
    "robotteamsim/Robots": _check_robots,
    "robotteamsim/NetworkState": _check_network,
    "robotteamsim/NetworkLinks": _check_links,
    "robotteamsim/NetworkMessages": _check_messages,
    "robotteamsim/Doors": _check_doors,
    "robotteamsim/Voice": _check_voice,
    "robotteamsim/MissionStatus": _check_mission,
    "robotteamsim/ControllerStatus": _check_controller,
    "sensor_msgs/Range": _check_range,
}
