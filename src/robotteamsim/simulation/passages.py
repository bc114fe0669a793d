"""The stage in which robots go from one level of a building to another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from robotteamsim.control.driving.known_map import UNREACHABLE_M, known_map
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import Decision, Task
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.levels import ways
from robotteamsim.scenario.problems import suggestion
from robotteamsim.setup import Setup
from robotteamsim.world.contract import AnyWorld

_EQUAL_M = 1e-3
"""Paths whose lengths differ by less are equal: lengths are float32."""
_PLACES = 8
"""Beside a stop that is occupied, so many places around it are tried."""


class _End(NamedTuple):
    """A stop, and where one gets from it: one way of a passage in one direction."""

    place: Point
    radius_m: float
    other: Point
    length_m: float
    time_ns: int


class _Trip(NamedTuple):
    """A robot on its way to a stop, where it arrives at a time."""

    end: _End
    arrival: int
    until_ns: int


class PassageStage:
    """The robots on stairs, ramps and in lifts.

    A robot at a stop leaves it if the shortest way to its goal (`Decision.goal_m`) leads over this passage, or to its
    area if the stop itself is its goal, or if it was told to by `take`. It stands at the stop for as long as the way
    takes, and is then at the other stop, or beside it if that is occupied. It goes back only after it has left that.
    """

    def __init__(self, setup: Setup, world: AnyWorld) -> None:
        plan = setup.scenario.plan
        self._setup, self._world, self._levels = setup, world, plan.levels
        self._ends: list[_End] = []
        for way in ways(plan.levels, plan.passages):
            if not way.passage.takes_robots:
                continue
            for place, other in ((way.start, way.end), (way.end, way.start)):
                time_ns = round(way.time_s * 1e9)
                self._ends.append(_End(place, way.passage.radius_m, other, way.equivalent_m, time_ns))
        self._areas = [area.center for area in setup.scenario.mission.areas]
        self._trips: dict[int, _Trip] = {}
        self._came_by: dict[int, _End] = {}
        """Of robots that have not left the stop at which they have arrived."""
        self._told: dict[int, str] = {}

    def take(self, robot_id: int, level: str) -> None:
        """Let a robot that is at a stop go to a level, or the next time that it is at a stop from which it can.

        Raises: ValueError: no such robot, it is absent, or no such level.
        """
        if robot_id not in range(self._world.num_robots) or not self._world.present[robot_id]:
            raise ValueError(f"take_passage: robot {robot_id!r:.60} is not there")
        names = [one.name for one in self._levels]
        if level not in names:
            known = f"expected one of {', '.join(names)}{suggestion(str(level), names)}"
            raise ValueError(f"take_passage: there is no level {level!r:.60}; {known}")
        self._told[robot_id] = level

    def held(self, twists: Sequence[Twist]) -> Sequence[Twist]:
        """Return the commands of a step, in which those who are on a way stand still."""
        if not self._trips:
            return twists
        return [Twist() if robot_id in self._trips else twist for robot_id, twist in enumerate(twists)]

    def step(self, decisions: Sequence[Decision], task: Task) -> None:
        """Let robots leave and arrive after a step of the world. Args: decisions: by which it was made."""
        world = self._world
        for robot_id, pose in enumerate(world.poses()):
            trip = self._trips.get(robot_id)
            if not world.present[robot_id] or (trip is not None and trip.arrival != world.arrivals[robot_id]):
                for known in (self._trips, self._told, self._came_by):
                    known.pop(robot_id, None)
            elif trip is None:
                end = self._taken(robot_id, (pose.x_m, pose.y_m), decisions[robot_id], task)
                if end is not None:
                    self._told.pop(robot_id, None)
                    until_ns = world.sim_time_ns + end.time_ns
                    self._trips[robot_id] = _Trip(end, world.arrivals[robot_id], until_ns)
            elif world.sim_time_ns >= trip.until_ns and self._arrives(robot_id, trip.end, pose):
                self._came_by[robot_id] = self._trips.pop(robot_id).end

    def _taken(self, robot_id: int, position: Point, decision: Decision, task: Task) -> _End | None:
        """Return the way that a robot takes from here; None: it stays."""
        came_by = self._came_by.get(robot_id)
        if came_by is not None and math.dist(came_by.other, position) > 2.0 * came_by.radius_m:
            del self._came_by[robot_id]
        here = [end for end in self._ends if math.dist(end.place, position) <= end.radius_m]
        if not here:
            return None
        if told := self._told.get(robot_id):
            level = next(one for one in self._levels if one.name == told)
            return next((end for end in here if level.bounds.contains(end.other)), None)
        goal = decision.goal_m
        if goal is not None and math.dist(goal, here[0].place) <= 2.0 * here[0].radius_m:
            goal = task.area_center_m if decision.area < 0 else self._areas[decision.area]
        if goal is None:
            return None
        known = known_map(self._setup.building, self._setup.robots[robot_id].reach_m)
        shortest_m = {end: end.length_m + known.distance_m(goal, end.other) for end in here}
        best = min(here, key=shortest_m.__getitem__)
        is_shortest = shortest_m[best] <= known.distance_m(goal, best.place) + _EQUAL_M
        goes_back = came_by is not None and best.other == came_by.place
        return best if is_shortest and shortest_m[best] < UNREACHABLE_M and not goes_back else None

    def _arrives(self, robot_id: int, end: _End, pose: Pose) -> bool:
        """Set a robot to the other stop of a way as it stood at this one, or beside it; whether there was room."""
        angles = [math.tau * k / _PLACES for k in range(_PLACES)]
        beside = [(end.radius_m * math.cos(angle), end.radius_m * math.sin(angle)) for angle in angles]
        for dx, dy in ((pose.x_m - end.place[0], pose.y_m - end.place[1]), (0.0, 0.0), *beside):
            try:
                self._world.set_pose(robot_id, Pose(end.other[0] + dx, end.other[1] + dy, pose.yaw_rad))
            except PlacementError:
                continue
            return True
        return False
