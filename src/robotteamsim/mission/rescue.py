"""How victims get from their place to safety when firefighters save them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Literal

import msgspec
import numpy as np

from robotteamsim.interface import Decision
from robotteamsim.interface.firefighter import parse_firefighter_update
from robotteamsim.interface.task import Assistance
from robotteamsim.mission.egress import AT_CENTRE
from robotteamsim.mission.events import (
    VictimCarried,
    VictimLeft,
    VictimLocated,
    VictimNotFound,
    VictimReached,
    VictimSafe,
)
from robotteamsim.mission.exits import exit_at
from robotteamsim.mission.sensed import Sensed
from robotteamsim.mission.status import VictimState
from robotteamsim.mission.victims import VictimNews, Victims
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.rescue import Exit
from robotteamsim.scenario.sections import Victim
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.sensing.sight import Sight
from robotteamsim.setup import Setup

_UNKNOWN: tuple[VictimState, ...] = ("waiting", "heard", "collapsed")
_WAITING: tuple[VictimState, ...] = (*_UNKNOWN, "located", "reported")
_ROBOTS = -1
"""Replaces the id of a robot: all robots together know where a victim was last seen; each firefighter knows alone."""


class Rescue:
    """Judges who is located, reached, picked up and safe.

    A victim is located by whoever sees them, or hears them as loudly as `mission.rescue.located_voice_db`, and then
    calls no more, unless a firefighter reports that they were not found. A firefighter within `mission.save_distance_m`
    reaches a victim, helps nobody else meanwhile, and leaves with the victim after `pick_up_s`. Those who are carried
    or led are safe near the command centre, and in exits; `Exits` judges all others.
    """

    def __init__(self, setup: Setup, speaker: Callable[[Point], str | None]) -> None:
        """Args: speaker: see `Mission`."""
        self._name_of_speaker = speaker
        scenario, mission = setup.scenario, setup.scenario.mission
        self._section, self._reach_m = mission.rescue, mission.save_distance_m
        self._firefighters = scenario.firefighter_ids
        self._sight = Sight(scenario.plan, mission.rescue, scenario.team_size, scenario.run.seed)
        assert scenario.base is not None, "firefighters need a command centre"
        centre = Exit(name=AT_CENTRE, center=setup.start_m(scenario.base), radius_m=mission.rescue.safe_m)
        self._safe_places = (*mission.exits, centre)
        self._helps: dict[int, Assistance] = {}
        """By index of the victim."""
        self._reached_s: dict[int, float] = {}
        self._time_s = 0.0
        """Of the step that is judged [s of the mission]."""
        self._last_seen_m: dict[tuple[int, int], Point] = {}
        """Where a victim was located last, by observer and victim."""
        self._located_s: dict[int, float] = {}
        """When a victim was located last, by index [s of the mission]."""

    @property
    def assistance(self) -> tuple[Assistance, ...]:
        """The firefighters who help somebody, in the order of the victims."""
        return tuple(help_ for _, help_ in sorted(self._helps.items()))

    def harm(self, index: int, state: VictimState) -> None:
        """Note that a victim has collapsed or died."""
        if state == "dead":
            self._helps.pop(index, None)
        elif index in self._helps:
            self._helps[index] = msgspec.structs.replace(self._helps[index], collapsed=True)

    def forget(self, index: int) -> None:
        """Forget everything about a victim, who is somewhere else now."""
        self._helps.pop(index, None)
        self._last_seen_m = {key: place for key, place in self._last_seen_m.items() if key[1] != index}

    def judge(
        self, time_s: float, now: Sensed, decisions: Sequence[Decision], victims: Victims
    ) -> Iterator[VictimNews]:
        """Yield what happens in a step. The caller applies each change of the victims before it takes the next one.

        Args: time_s: of the mission's clock [s].
        """
        self._time_s = time_s
        if now.doors:
            self._sight.follow_doors(now.doors)
        there_m = np.where(now.present[:, None], now.state.positions_m, math.nan)
        yield from self._located_by_voice(there_m, now, victims)
        yield from self._seen(there_m, now, victims)
        yield from self._not_found(decisions, victims)
        yield from self._given_up(there_m, victims)
        yield from self._reached(time_s, there_m, now.enclosed, victims)
        yield from self._picked_up(time_s, victims)
        yield from self._safe(victims)

    def _located_by_voice(self, there_m: np.ndarray, now: Sensed, victims: Victims) -> Iterator[VictimNews]:
        # All voices of a step are those of whoever called before it, also if they fall silent in this step.
        speakers = [(robot_id, self._speaker(voice, victims)) for robot_id, voice in enumerate(now.voices)]
        located: set[int] = set()
        for robot_id, index in speakers:
            if index is None or index in located or math.isnan(there_m[robot_id, 0]):
                continue
            if victims.needs_help(index, now.enclosed):
                located.add(index)
                yield self._located(index, robot_id, now.voices[robot_id].local_best_m, "voice", victims.all[index])

    def _speaker(self, voice: VoiceReading, victims: Victims) -> int | None:
        """Return the index of the victim whose loud voice this is; None if it is not loud, or they are silent."""
        if not voice.heard or voice.local_best_level_db < self._section.located_voice_db:
            return None
        name = self._name_of_speaker(voice.local_best_m)
        return None if name is None or name in victims.silent else victims.index(name)

    def _seen(self, there_m: np.ndarray, now: Sensed, victims: Victims) -> Iterator[VictimNews]:
        states, enclosed = victims.states, now.enclosed
        wanted = [
            index
            for index, victim in enumerate(victims.all)
            if states[index] in _WAITING and index not in self._helps and victims.needs_help(index, enclosed)
        ]
        seen_m = [victims.all[index].position for index in wanted]
        visibility_m = None if now.smoke is None else now.smoke.visibility_m(there_m)
        for robot_id, place in self._sight.pairs(there_m, seen_m, visibility_m):
            index = wanted[place]
            victim = victims.all[index]
            last_m = self._last_seen_m.get((self._observer(robot_id), index))
            has_moved = last_m is None or math.dist(last_m, victim.position) > self._section.moved_m
            if states[index] in _UNKNOWN or has_moved:
                observer_m = (float(there_m[robot_id, 0]), float(there_m[robot_id, 1]))
                measured_m = self._sight.measured_m(robot_id, observer_m, victim.position)
                if states[index] in _UNKNOWN:
                    yield self._located(index, robot_id, measured_m, "sight", victim)
                else:
                    self._last_seen_m[self._observer(robot_id), index] = measured_m
                    self._located_s[index] = self._time_s
                    yield VictimNews(index, found=(robot_id, measured_m))

    def _located(
        self, index: int, robot_id: int, seen_m: Point, by: Literal["sight", "voice"], victim: Victim
    ) -> VictimNews:
        self._last_seen_m[self._observer(robot_id), index] = seen_m
        self._located_s[index] = self._time_s
        event = VictimLocated(victim.name, by, math.dist(seen_m, victim.position), robot_id=robot_id)
        return VictimNews(index, "located", event, (robot_id, seen_m))

    def _not_found(self, decisions: Sequence[Decision], victims: Victims) -> Iterator[VictimNews]:
        """Yield the victims whom a firefighter reports as missing, unless they were located since: they call again."""
        for robot_id in self._firefighters:
            reports = [parse_firefighter_update(message.payload) for message in decisions[robot_id].outbox]
            missing = {pair for report in reports if report is not None for pair in report.missing}
            for name, news_s in sorted(missing):
                index = victims.index(name)
                if index is None or victims.states[index] not in ("located", "reported"):
                    continue
                if self._located_s[index] <= news_s:
                    yield VictimNews(index, "waiting", VictimNotFound(name, robot_id=robot_id))

    def _given_up(self, there_m: np.ndarray, victims: Victims) -> Iterator[VictimNews]:
        """Yield the victims whose firefighter has left the team: they call again, unless they have collapsed."""
        for index, assistance in list(self._helps.items()):
            if math.isnan(there_m[assistance.robot_id, 0]):
                del self._helps[index]
                name = victims.all[index].name
                state: VictimState = "collapsed" if name in victims.collapsed else "waiting"
                yield VictimNews(index, state, VictimLeft(name, robot_id=assistance.robot_id))

    def _reached(
        self, time_s: float, there_m: np.ndarray, enclosed: frozenset[str], victims: Victims
    ) -> Iterator[VictimNews]:
        busy = {assistance.robot_id for assistance in self._helps.values()}
        for robot_id in self._firefighters:
            x, y = there_m[robot_id].tolist()
            if robot_id in busy or math.isnan(x):
                continue
            near = [
                (math.dist((x, y), victim.position), index)
                for index, victim in enumerate(victims.all)
                if victims.states[index] in _WAITING and victims.needs_help(index, enclosed)
            ]
            if near and min(near)[0] <= self._reach_m:
                index = min(near)[1]
                name = victims.all[index].name
                self._helps[index] = Assistance(robot_id, name, moving=False, collapsed=name in victims.collapsed)
                self._reached_s[index] = time_s
                yield VictimNews(index, "reached", VictimReached(name, robot_id=robot_id))

    def _picked_up(self, time_s: float, victims: Victims) -> Iterator[VictimNews]:
        for index, assistance in list(self._helps.items()):
            if not assistance.moving and time_s - self._reached_s[index] >= self._section.pick_up_s:
                self._helps[index] = msgspec.structs.replace(assistance, moving=True)
                walks = victims.all[index].can_walk and not assistance.collapsed
                event = VictimCarried(assistance.victim, walks, robot_id=assistance.robot_id)
                yield VictimNews(index, "carried", event)

    def _safe(self, victims: Victims) -> Iterator[VictimNews]:
        for index, victim in enumerate(victims.all):
            if victims.states[index] != "carried":
                continue
            if (way_out := exit_at(self._safe_places, victim.position)) is not None:
                helper = self._helps.pop(index)
                yield VictimNews(index, "safe", VictimSafe(victim.name, way_out, robot_id=helper.robot_id))

    def _observer(self, robot_id: int) -> int:
        return robot_id if robot_id in self._firefighters else _ROBOTS
