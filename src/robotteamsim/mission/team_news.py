"""What happens to the robots in the world, as events: mishaps, and objects that they lift and drop."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from robotteamsim.world.contract import Mishap

_MISHAPS: dict[Mishap, str] = {"tipped_over": "tips over", "left_world": "leaves the world"}


class News(NamedTuple):
    """The parts of an event."""

    kind: str
    subject: str
    robot_id: int
    detail: str


class TeamNews:
    """Compares what the world reports with the last report."""

    def __init__(self) -> None:
        self._mishaps: Mapping[int, Mishap] = {}
        self._loads: Mapping[int, str] = {}

    def of(self, mishaps: Mapping[int, Mishap], loads: Mapping[int, str]) -> Iterator[News]:
        """Yield what is new. Args: mishaps, loads: by the ids of robots, as in `AnyWorld`."""
        for robot_id, mishap in mishaps.items():
            if self._mishaps.get(robot_id) != mishap:
                yield News(f"robot_{mishap}", "", robot_id, f"robot {robot_id} {_MISHAPS[mishap]}")
        for robot_id in sorted(self._loads.keys() | loads.keys()):
            before, now = self._loads.get(robot_id), loads.get(robot_id)
            if before is not None and before != now:
                yield News("object_dropped", before, robot_id, f"robot {robot_id} drops {before}")
            if now is not None and before != now:
                yield News("object_lifted", now, robot_id, f"robot {robot_id} lifts {now}")
        self._mishaps, self._loads = mishaps, loads
