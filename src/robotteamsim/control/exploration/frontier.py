"""The controller `frontier`: a team that explores a building that nobody knows."""

from __future__ import annotations

import math

import msgspec

from robotteamsim.control.baselines.searching import RouteController
from robotteamsim.control.driving.known_map import Disc
from robotteamsim.control.driving.path_controller import Situation
from robotteamsim.control.exploration.choice import Choice
from robotteamsim.interface import Decision, Task
from robotteamsim.interface.payload import Index, Point, Update, update_reader
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.controllers.frontier import FrontierControl
from robotteamsim.scenario.sections import Area
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_STALE_S = 10.0
"""The goal of a teammate that was not heard for so long does not count."""


class FrontierUpdate(Update, frozen=True, tag="frontier"):
    """What a robot shares in each iteration.

    goal:        where it goes, in `map` [m]; None: it has nothing left to explore.
    voice:       whether it follows a voice there; else left out.
    closed_area: centre of the area of the task, if the robot does not get there; else left out.
    """

    robot_id: Index
    goal: Point | None
    voice: bool | msgspec.UnsetType = msgspec.UNSET
    closed_area: Point | msgspec.UnsetType = msgspec.UNSET


parse_frontier_update = update_reader(FrontierUpdate, kept=256)


class FrontierController(RouteController):
    """Drives to a frontier of the map that its team has found, and to the voices that it hears on the way.

    Robots choose one after the other, and tell each other their goals. A robot without a goal stands still until
    nobody who is heard has one; then all drive to the last area, which ends the mission. A robot is done when
    everything is explored but areas to which it does not get.
    """

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        self._choosing = tuning = setup.scenario.control.as_kind(FrontierControl)
        super().__init__(robot_id, setup, tuning)
        self._choice = Choice(robot_id, setup, tuning, arrival)
        self._updates: dict[int, FrontierUpdate] = {}
        """The last one of each teammate."""
        self._heard_s: dict[int, float] = {}
        """When each teammate was last heard."""
        self._meeting_m = setup.start_m(0)
        # One after the other, also at first, so that each knows the goals of those before it.
        self._turn_s = tuning.replan_s * robot_id / setup.scenario.num_robots
        self._first_s = min(robot_id * setup.scenario.control.iteration_s, tuning.replan_s)
        self._turn: int | None = None
        """In which it chose last; None: it chooses now."""
        self._chosen_s = 0.0
        self._goal: Vector | None = None
        self._aim: Vector | None = None
        """Where it drives: to its goal or, without one, to the last area."""
        self._is_idle = self._follows_voice = False

    @property
    def is_searched(self) -> bool:
        """Whether nobody who was heard lately has anything left to explore."""
        return self._is_idle and not self._goals_of_team

    def decide(self, now: Situation) -> Decision:
        """Return the command of this step; once everything is explored, the reason why nothing is left to do."""
        decision, left = super().decide(now), self._areas.left
        if not self.is_searched or self._voice_m is not None or any(not self._is_missed(area) for area in left):
            return decision
        missed = f"; {', '.join(area.name for area in left)} cannot be reached" if left else ""
        return msgspec.structs.replace(decision, done=f"everything within reach is explored{missed}")

    def note(self, now: Situation) -> None:
        """Listen to the team."""
        for message in now.inbox:
            update = parse_frontier_update(message.payload)
            if update is not None and update.robot_id != self.robot_id:
                self._updates[update.robot_id], self._heard_s[update.robot_id] = update, now.time_s

    def kept_out(self, task: Task) -> Disc | None:
        """Return the last area until the floor has been searched; with another one, the robot chooses again."""
        before, kept_out = self._kept_out_now, super().kept_out(task)
        if kept_out != before:
            self._turn = self._aim = None
        return kept_out

    def _look(self, now: Situation) -> tuple[Message, ...]:
        if self._voice_m is not None and self._is_left_to_others(self._voice_m, now.time_s):
            self._voice_m = None
        self._follows_voice = self._voice_m is not None
        turn = math.floor((now.time_s + self._turn_s) / self._choosing.replan_s)
        if self._voice_m is not None:
            self._turn, self._chosen_s = None, now.time_s  # The time on the way to a victim is not wasted.
        elif now.time_s >= self._first_s and (turn != self._turn or self._has_arrived(now.position)):
            self._turn = turn
            self._choose(now)
        area = self._areas.next
        closed = area.center if area is not None and self._is_missed(area) else msgspec.UNSET
        follows = True if self._voice_m is not None else msgspec.UNSET
        update = FrontierUpdate(self.robot_id, self._voice_m or self._goal, follows, closed)
        return (Message(self.robot_id, EVERYBODY, update.to_json()),)

    def _choose(self, now: Situation) -> None:
        """Choose where to drive until the next turn."""
        spent_s, self._chosen_s, self._place = now.time_s - self._chosen_s, now.time_s, None
        left = self._areas.left
        next_ones = left[:1] if now.task.areas_left is None else left
        team = self._goals_of_team
        if self._is_somebody_missing(now.time_s):
            self._goal = self._meeting_m
        else:
            # Also once paths may enter the last area: else, floor in it or behind it would close it again.
            outside = self.driver.map_outside(self._areas.kept_out_soon)
            self._goal = self._choice.choose(
                outside, now.position, [a for a in next_ones if a is not left[-1]], team, spent_s
            )
        self._aim, self._is_idle = self._goal, self._goal is None
        if len(left) == 1:
            # It is not missed because paths do not enter it yet.
            self._choice.missed.discard(left[0].center)
            if self.is_searched and self._kept_out_now is None:
                self._aim = self._choice.way_to(left[0], self.driver.map, now.position, spent_s)

    @property
    def _goals_of_team(self) -> list[Vector]:
        """The goals of the teammates that were heard lately, at the time of the last choice."""
        return [update.goal for update in self._lately(self._chosen_s) if update.goal is not None]

    def _lately(self, time_s: float) -> list[FrontierUpdate]:
        """Return the last updates of the teammates that had been heard not long before a time."""
        return [self._updates[i] for i, heard_s in self._heard_s.items() if heard_s >= time_s - _STALE_S]

    def _is_left_to_others(self, voice_m: Vector, time_s: float) -> bool:
        """Whether a teammate follows a voice: one who was first or, if two begin together, has the lower id."""
        radius_m = self.scenario.voice.local_best_radius_m
        following = ((each.robot_id, each.goal) for each in self._lately(time_s) if each.voice is True)
        near = [i for i, goal in following if goal is not None and math.dist(goal, voice_m) <= radius_m]
        return any(i < self.robot_id or not self._follows_voice for i in near)

    def _is_somebody_missing(self, time_s: float) -> bool:
        """Whether a teammate has been silent for `rendezvous_s`; after twice this time, it counts as lost."""
        limit_s = self._choosing.rendezvous_s
        silent_s = [time_s - heard_s for heard_s in self._heard_s.values()]
        return limit_s is not None and any(limit_s <= each_s < 2.0 * limit_s for each_s in silent_s)

    def _is_missed(self, area: Area) -> bool:
        return area.center in self._choice.missed

    def _has_arrived(self, position: Vector) -> bool:
        return self._goal is not None and math.dist(position, self._goal) < self._tuning.arrived_m

    def _next_place(self, position: Vector, is_done: bool) -> Vector:
        return self._aim or position

    def _set_out(self, place: Vector, now: Situation) -> None:
        # The robot gives up by its patience.
        pass

    def _is_done(self, place: Vector, now: Situation) -> bool:
        # The robot chooses at its turn.
        return False
