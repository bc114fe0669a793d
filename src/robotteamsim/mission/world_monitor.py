"""Watches the world for what is an event: doors, robots that come, go or cannot go on, objects that they carry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from robotteamsim.mission.events import (
    DoorChanged,
    DoorMoves,
    FirefighterCollapsed,
    Happening,
    ObjectDropped,
    ObjectLifted,
    PersonEnclosed,
    RobotFailedByHeat,
    RobotLeftWorld,
    RobotRemoved,
    RobotSpawned,
    RobotTippedOver,
)
from robotteamsim.mission.input import MissionInput
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates

_MISHAPS: dict[Mishap, type[Happening]] = {"tipped_over": RobotTippedOver, "left_world": RobotLeftWorld}


class WorldMonitor:
    """Compares each step with the one before."""

    def __init__(self, scenario: Scenario) -> None:
        self._doors = DoorStates.at_start(scenario.plan)
        self._enclosed: frozenset[str] = frozenset()
        self._mishaps: Mapping[int, Mishap] = {}
        self._loads: Mapping[int, str] = {}
        self._team_version = -1
        self._present = np.array(scenario.present_at_start, dtype=bool)
        self.is_empty = not self._present.any()
        """Whether nobody is present, as of the last step."""
        self._firefighters = frozenset(scenario.firefighter_ids)

    def changes(self, now: MissionInput) -> Iterator[Happening]:
        """Yield what has happened to doors, people, robots and objects."""
        if now.doors:
            yield from self._door_changes(now.doors)
        if now.people:
            yield from self._newly_enclosed(now.enclosed)
        for robot_id, mishap in now.mishaps.items():
            if self._mishaps.get(robot_id) != mishap:
                yield _MISHAPS[mishap](robot_id=robot_id)
        if now.loads != self._loads:
            yield from self._load_changes(now.loads)
        self._mishaps = now.mishaps

    def departures_and_arrivals(self, now: MissionInput) -> Iterator[Happening]:
        """Yield who has left the team, and why, and who has arrived."""
        if now.team_version == self._team_version:
            return
        before, present = self._present, now.present
        self._team_version, self._present, self.is_empty = now.team_version, present, not present.any()
        for robot_id in np.flatnonzero(before & ~present).tolist():
            yield self._why_gone(robot_id, now.failed)(robot_id=robot_id)
        for robot_id in np.flatnonzero(present & ~before).tolist():
            yield RobotSpawned(robot_id=robot_id)

    def _door_changes(self, doors: DoorStates) -> Iterator[Happening]:
        for name, before, now in doors.changes_since(self._doors):
            if now.closed != before.closed:
                yield DoorChanged(name, now.closed)
            elif now.motion != before.motion:
                yield DoorMoves(name, now.motion, now.opening)
        self._doors = doors

    def _newly_enclosed(self, enclosed: frozenset[str]) -> Iterator[Happening]:
        for name in sorted(enclosed - self._enclosed):
            yield PersonEnclosed(name)
        self._enclosed = enclosed

    def _load_changes(self, loads: Mapping[int, str]) -> Iterator[Happening]:
        for robot_id in sorted(self._loads.keys() | loads.keys()):
            before, held = self._loads.get(robot_id), loads.get(robot_id)
            if before is not None and before != held:
                yield ObjectDropped(before, robot_id=robot_id)
            if held is not None and before != held:
                yield ObjectLifted(held, robot_id=robot_id)
        self._loads = loads

    def _why_gone(self, robot_id: int, failed: frozenset[int]) -> type[Happening]:
        if robot_id not in failed:
            return RobotRemoved
        return FirefighterCollapsed if robot_id in self._firefighters else RobotFailedByHeat
