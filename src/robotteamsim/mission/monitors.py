"""Watches the links, the team and the world from step to step: changes become events of the mission."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from robotteamsim.interface import OUTSIDE, Decision
from robotteamsim.mission.events import (
    ControllerFailed,
    DoorBurnt,
    DoorChanged,
    DoorMoves,
    FireStarted,
    Happening,
    LinkEndangered,
    PersonEnclosed,
)
from robotteamsim.mission.sensed import Sensed
from robotteamsim.mission.team_events import (
    FirefighterCollapsed,
    LevelChanged,
    ObjectDropped,
    ObjectLifted,
    RobotExcluded,
    RobotFailedByHeat,
    RobotIncluded,
    RobotLeftWorld,
    RobotRemoved,
    RobotSpawned,
    RobotTippedOver,
    SwarmDissolved,
    SwarmFounded,
)
from robotteamsim.network.messages import NetworkState
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates

_MISHAPS: dict[Mishap, type[Happening]] = {"tipped_over": RobotTippedOver, "left_world": RobotLeftWorld}


class WorldMonitor:
    """Compares each step with the one before."""

    def __init__(self, scenario: Scenario) -> None:
        self._doors = DoorStates.at_start(scenario.plan)
        self._num_ignited = 0
        self._burnt_doors: tuple[str, ...] = ()
        self._enclosed: frozenset[str] = frozenset()
        self._mishaps: Mapping[int, Mishap] = {}
        self._loads: Mapping[int, str] = {}
        self._team_version = -1
        self._present = np.array(scenario.present_at_start, dtype=bool)
        self.is_empty = not self._present.any()
        """Whether nobody is present, as of the last step."""
        self._firefighters = frozenset(scenario.firefighter_ids)
        self._levels = scenario.plan.levels if scenario.plan.passages else ()
        self._corners_m = np.array([(*level.bounds.min, *level.bounds.max) for level in self._levels]).reshape(-1, 4).T
        self._level_of: tuple[int | None, ...] = ()

    def level_of(self, now: Sensed) -> tuple[int | None, ...]:
        """Return the index of the level on which each robot is, in id order; None: on none, or absent.

        It is () if no passage leads to another level.
        """
        if not self._levels:
            return ()
        x_m, y_m = now.state.positions_m.T[:, :, None]
        left_m, low_m, right_m, high_m = self._corners_m
        inside = (x_m >= left_m) & (x_m <= right_m) & (y_m >= low_m) & (y_m <= high_m)
        is_on = inside.any(axis=1) & now.present
        levels = zip(inside.argmax(axis=1).tolist(), is_on.tolist(), strict=True)
        return tuple([i if there else None for i, there in levels])

    def changes(self, now: Sensed) -> Iterator[Happening]:
        """Yield what has happened to fuel, doors, people, robots, objects and who is on which level."""
        for fuel, position_m, spread in now.ignited[self._num_ignited :]:
            yield FireStarted(fuel, position_m, spread)
        for name in now.burnt_doors:
            if name not in self._burnt_doors:
                yield DoorBurnt(name)
        self._num_ignited, self._burnt_doors = len(now.ignited), now.burnt_doors
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
        if (level_of := self.level_of(now)) != self._level_of:
            for robot_id, (before, on) in enumerate(zip(self._level_of, level_of, strict=False)):
                if before is not None and on is not None and on != before:
                    yield LevelChanged(self._levels[on].name, robot_id=robot_id)
            self._level_of = level_of

    def departures_and_arrivals(self, now: Sensed) -> Iterator[Happening]:
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


_ABSENT = -2
"""Replaces the swarm of an absent robot."""


class TeamMonitor:
    """Compares the decisions of each step with those of the previous one.

    A swarm consists of the robots whose decisions name it. Each robot decides for itself, so robots that leave, join or
    found a swarm together may do so in different steps. Outsiders and absent robots belong to no swarm.
    """

    def __init__(self, outsiders: Collection[int] = ()) -> None:
        """Args: outsiders: ids of the base and of the firefighters."""
        self._outsiders = outsiders
        self._statuses: list[tuple[bool, int, str, str]] = []
        """Excluded, swarm, fault and done of each robot in the last step."""
        self._is_there: list[bool] = []
        """Whether each robot was present in the last step."""
        self.all_excluded = False
        """Whether no present robot belongs to a swarm."""
        self.done = ""
        """Why the team has nothing left to do, according to its first robot; "" while any working robot has."""
        self._swarms: list[int] = []
        self._faults: list[str] = []

    def changes(self, decisions: Sequence[Decision], present: np.ndarray) -> list[Happening]:
        """Return the changes since the last step, in id order; the end of a swarm follows the robots that left it.

        Args: present: whether each robot is present, bool, shape (n,).
        """
        statuses, is_there = [(d.excluded, d.swarm, d.fault, d.done) for d in decisions], present.tolist()
        if statuses == self._statuses and is_there == self._is_there:
            return []
        self._statuses, self._is_there = statuses, is_there
        swarms = [OUTSIDE if excluded else swarm for excluded, swarm, *_ in statuses]
        faults = [fault for *_, fault, _ in statuses]
        self.done = self._done(statuses, is_there)
        for outsider in self._outsiders:
            swarms[outsider] = OUTSIDE
        swarms = [swarm if there else _ABSENT for swarm, there in zip(swarms, is_there, strict=True)]
        before = self._swarms or self._at_first(swarms)
        found = [*_changes_of_swarms(before, swarms), *_new_faults(self._faults or [""] * len(faults), faults)]
        self._swarms, self._faults = swarms, faults
        self.all_excluded = len(swarms) > len(self._outsiders) and all(s in (OUTSIDE, _ABSENT) for s in swarms)
        return found

    def _done(self, statuses: list[tuple[bool, int, str, str]], is_there: list[bool]) -> str:
        """Return the reason of the first robot if all are done; absent, stopped robots and outsiders do not count."""
        reasons = [
            done
            for robot_id, (_, _, fault, done) in enumerate(statuses)
            if is_there[robot_id] and robot_id not in self._outsiders and not fault
        ]
        return reasons[0] if all(reasons) and reasons else ""

    def _at_first(self, swarms: list[int]) -> list[int]:
        """Return the swarms before the first step; a robot that is excluded in it was in swarm 0."""
        return [0 if swarm == OUTSIDE and i not in self._outsiders else swarm for i, swarm in enumerate(swarms)]


def _changes_of_swarms(before: list[int], now: list[int]) -> Iterator[Happening]:
    there, left = set(before) - {OUTSIDE, _ABSENT}, set(now) - {OUTSIDE, _ABSENT}
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
        if _ABSENT in (old, new):
            continue  # Robots that are removed or spawned have events of their own.
        if old != new and new == OUTSIDE:
            yield RobotExcluded(old, robot_id=robot_id)
        if old != new and new in there:
            yield RobotIncluded(new, robot_id=robot_id)
    for swarm in sorted(left - there):
        founders = tuple(robot_id for robot_id, new in enumerate(now) if new == swarm)
        yield SwarmFounded(swarm, founders, robot_id=founders[0])
    for swarm in sorted(there - left):
        yield SwarmDissolved(swarm)


def _new_faults(before: list[str], now: list[str]) -> Iterator[Happening]:
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
        if new and not old:
            yield ControllerFailed(new, robot_id=robot_id)


class LinkMonitor:
    """Compares the network of each step with that of the step before."""

    def __init__(self, num_robots: int) -> None:
        self._version: int | None = None
        self._was_there = np.zeros(num_robots, bool)
        self._was_safe = np.zeros((num_robots, num_robots), bool)
        """Who was present, and which links were at or above the threshold, as of this version."""
        self.num_endangered = 0
        """How often a link fell below the threshold of endangered links so far, lost or not."""

    def news(self, network: NetworkState) -> list[LinkEndangered]:
        """Return the links that are newly endangered or lost, see `newly_endangered`."""
        if network.version == self._version:
            return []
        is_there, is_safe = np.diagonal(network.hop_count) >= 0, network.adjacency & ~network.endangered
        begun = self._was_safe & ~is_safe
        if not np.array_equal(is_there, self._was_there):
            were_both, are_both = (there[:, None] & there for there in (self._was_there, is_there))
            begun = np.where(were_both, begun, network.endangered) & are_both
        self._version, self._was_there, self._was_safe = network.version, is_there, is_safe
        pairs = [(i, j) for i, j in (divmod(k, len(begun)) for k in np.flatnonzero(begun).tolist()) if i < j]
        self.num_endangered += len(pairs)
        return [
            LinkEndangered(i, j, not network.adjacency[i, j], float(network.rssi_dbm[i, j]))  # as of this step
            for i, j in pairs
        ]
