"""How victims get from their place to safety when firefighters save them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

from robotteamsim.hazards import HazardField
from robotteamsim.interface.task import Assistance
from robotteamsim.mission.status import CALLING, VictimState
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Victim
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.sensing.sight import Sight
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState
from robotteamsim.world.placement import placed_robots

NOBODY = -1
_UNKNOWN: tuple[VictimState, ...] = ("waiting", "heard", "collapsed")
_WAITING: tuple[VictimState, ...] = (*_UNKNOWN, "located", "reported")
_ROBOTS = -1
"""Replaces the id of a robot: all robots together know where a victim was last seen; each firefighter knows alone."""


_OFF = ", {:.2f} m off"
"""The end of the detail of `victim_located`."""


def located_error_m(detail: str) -> float | None:
    """Return how far off a located position was, by the detail of the event `victim_located` [m]; None: unknown."""
    found = re.search(r", (\d+\.\d+) m off$", detail)
    return float(found[1]) if found else None


class VictimNews(msgspec.Struct, frozen=True, gc=False):
    """What happens to a victim in a step.

    index:      of the victim.
    state:      from now on; None: as before.
    kind, robot_id, detail: of the event; no event without a detail.
    position_m: where `robot_id` has located the victim, which is a discovery; None: it is none.
    """

    index: int
    state: VictimState | None
    kind: str
    robot_id: int
    detail: str
    position_m: Point | None = None


class Rescue:
    """Judges who is located, reached, picked up and safe.

    A victim is located by whoever sees them, or hears them as loudly as `mission.rescue.located_voice_db`, and then
    calls no more. A firefighter within `mission.save_distance_m` reaches a victim, helps nobody else meanwhile, and
    leaves with the victim after `pick_up_s`. Victims are safe near the command centre, and in exits.
    """

    def __init__(self, scenario: Scenario) -> None:
        mission = scenario.mission
        self._section, self._reach_m = mission.rescue, mission.save_distance_m
        self._firefighters, self._member = scenario.firefighter_ids, scenario.name_of
        self._sight = Sight(scenario.plan, mission.rescue, scenario.team_size, scenario.run.seed)
        self._safe_places = [(way_out.center, way_out.radius_m) for way_out in mission.exits]
        assert scenario.base is not None, "firefighters need a command centre"
        x, y, _ = placed_robots(scenario)[scenario.base].start_pose
        self._safe_places.append(((x, y), mission.rescue.safe_m))
        self._helps: dict[int, Assistance] = {}
        """By index of the victim."""
        self._reached_s: dict[int, float] = {}
        self._last_seen_m: dict[tuple[int, int], Point] = {}
        """Where a victim was located last, by observer and victim."""
        self._enclosed: frozenset[str] = frozenset()
        self._collapsed: set[str] = set()
        self._smoke: HazardField | None = None

    @property
    def assistance(self) -> tuple[Assistance, ...]:
        """The firefighters who help somebody, in the order of the victims."""
        return tuple(help_ for _, help_ in sorted(self._helps.items()))

    def follow_doors(self, doors: DoorStates) -> None:
        """Let robots and firefighters look past the doors in these states."""
        self._sight.follow_doors(doors)

    def follow_people(self, people: Sequence[PersonState]) -> list[str]:
        """Return the names of people who have just been enclosed; others who flee need no help."""
        before, self._enclosed = self._enclosed, frozenset(p.name for p in people if p.motion == "enclosed")
        return sorted(self._enclosed - before)

    def follow_smoke(self, field: HazardField) -> None:
        """Note the smoke that everybody looks through from now on."""
        self._smoke = field

    def harm(self, index: int, name: str, state: VictimState) -> None:
        """Note that a victim has collapsed or died."""
        self._collapsed.add(name)
        if state == "dead":
            self._helps.pop(index, None)
        elif index in self._helps:
            self._helps[index] = msgspec.structs.replace(self._helps[index], collapsed=True)

    def forget(self, index: int, name: str) -> None:
        """Forget everything about a victim, who is somewhere else now."""
        self._helps.pop(index, None)
        self._collapsed.discard(name)
        self._last_seen_m = {key: place for key, place in self._last_seen_m.items() if key[1] != index}

    def judge(
        self,
        time_s: float,
        positions_m: np.ndarray,
        present: np.ndarray | None,
        voices: Sequence[VoiceReading],
        victims: Sequence[Victim],
        states: Sequence[VictimState],
    ) -> Iterator[VictimNews]:
        """Yield what happens in a step. The caller applies each change of `states` before it takes the next one.

        Args: positions_m: of the team, shape (n, 2), in `map` [m].  present: bool, shape (n,); None: all are.
        """
        there_m = positions_m if present is None else np.where(present[:, None], positions_m, math.nan)
        yield from self._located_by_voice(there_m, voices, victims, states)
        yield from self._seen(there_m, victims, states)
        yield from self._given_up(there_m, victims)
        yield from self._reached(time_s, there_m, victims, states)
        yield from self._picked_up(time_s, victims)
        yield from self._safe(victims, states)

    def _located_by_voice(
        self,
        there_m: np.ndarray,
        voices: Sequence[VoiceReading],
        victims: Sequence[Victim],
        states: Sequence[VictimState],
    ) -> Iterator[VictimNews]:
        for robot_id, voice in enumerate(voices):
            if not voice.heard or voice.local_best_level_db < self._section.located_voice_db:
                continue
            calling = [
                (math.dist(victim.position, voice.local_best_m), index)
                for index, victim in enumerate(victims)
                if victim.calling and states[index] in CALLING and self._needs_help(victim)
            ]
            if calling and not math.isnan(there_m[robot_id, 0]):
                index = min(calling)[1]
                yield self._located(index, robot_id, voice.local_best_m, "voice", victims[index])

    def _seen(
        self, there_m: np.ndarray, victims: Sequence[Victim], states: Sequence[VictimState]
    ) -> Iterator[VictimNews]:
        wanted = [
            index
            for index, victim in enumerate(victims)
            if states[index] in _WAITING and index not in self._helps and self._needs_help(victim)
        ]
        seen_m = [victims[index].position for index in wanted]
        visibility_m = None if self._smoke is None else self._smoke.visibility_m(there_m)
        for robot_id, place in self._sight.pairs(there_m, seen_m, visibility_m):
            index = wanted[place]
            victim = victims[index]
            last_m = self._last_seen_m.get((self._observer(robot_id), index))
            has_moved = last_m is None or math.dist(last_m, victim.position) > self._section.moved_m
            if states[index] in _UNKNOWN or has_moved:
                observer_m = (float(there_m[robot_id, 0]), float(there_m[robot_id, 1]))
                measured_m = self._sight.measured_m(robot_id, observer_m, victim.position)
                if states[index] in _UNKNOWN:
                    yield self._located(index, robot_id, measured_m, "sight", victim)
                else:
                    self._last_seen_m[self._observer(robot_id), index] = measured_m
                    yield VictimNews(index, None, "", robot_id, "", measured_m)

    def _located(self, index: int, robot_id: int, seen_m: Point, by: str, victim: Victim) -> VictimNews:
        self._last_seen_m[self._observer(robot_id), index] = seen_m
        error_m = math.dist(seen_m, victim.position)
        detail = f"{self._member(robot_id)} locates {victim.name} by {by}{_OFF.format(error_m)}"
        return VictimNews(index, "located", "victim_located", robot_id, detail, seen_m)

    def _given_up(self, there_m: np.ndarray, victims: Sequence[Victim]) -> Iterator[VictimNews]:
        """Yield the victims whose firefighter has left the team: they call again, unless they have collapsed."""
        for index, assistance in list(self._helps.items()):
            if math.isnan(there_m[assistance.robot_id, 0]):
                del self._helps[index]
                name = victims[index].name
                state: VictimState = "collapsed" if name in self._collapsed else "waiting"
                detail = f"{name} is left by {self._member(assistance.robot_id)}"
                yield VictimNews(index, state, "victim_left", assistance.robot_id, detail)

    def _reached(
        self, time_s: float, there_m: np.ndarray, victims: Sequence[Victim], states: Sequence[VictimState]
    ) -> Iterator[VictimNews]:
        busy = {assistance.robot_id for assistance in self._helps.values()}
        for robot_id in self._firefighters:
            x, y = there_m[robot_id].tolist()
            if robot_id in busy or math.isnan(x):
                continue
            near = [
                (math.dist((x, y), victim.position), index)
                for index, victim in enumerate(victims)
                if states[index] in _WAITING and self._needs_help(victim)
            ]
            if near and min(near)[0] <= self._reach_m:
                index = min(near)[1]
                name = victims[index].name
                self._helps[index] = Assistance(robot_id, name, moving=False, collapsed=name in self._collapsed)
                self._reached_s[index] = time_s
                yield VictimNews(
                    index, "reached", "victim_reached", robot_id, f"{self._member(robot_id)} reaches {name}"
                )

    def _picked_up(self, time_s: float, victims: Sequence[Victim]) -> Iterator[VictimNews]:
        for index, assistance in list(self._helps.items()):
            if not assistance.moving and time_s - self._reached_s[index] >= self._section.pick_up_s:
                self._helps[index] = msgspec.structs.replace(assistance, moving=True)
                walks = victims[index].can_walk and not assistance.collapsed
                does = "leads" if walks else "carries"
                detail = f"{self._member(assistance.robot_id)} {does} {assistance.victim}"
                yield VictimNews(index, "carried", "victim_carried", assistance.robot_id, detail)

    def _safe(self, victims: Sequence[Victim], states: Sequence[VictimState]) -> Iterator[VictimNews]:
        for index, victim in enumerate(victims):
            is_moved = states[index] == "carried" or (victim.flees and states[index] in _WAITING)
            if is_moved and any(math.dist(victim.position, place) <= within for place, within in self._safe_places):
                assistance = self._helps.pop(index, None)
                robot_id = NOBODY if assistance is None else assistance.robot_id
                yield VictimNews(index, "safe", "victim_safe", robot_id, f"{victim.name} is safe")

    def _needs_help(self, victim: Victim) -> bool:
        return not victim.flees or victim.name in self._enclosed or victim.name in self._collapsed

    def _observer(self, robot_id: int) -> int:
        return robot_id if robot_id in self._firefighters else _ROBOTS
