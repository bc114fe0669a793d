"""The stage in which robots and firefighters go from one level of a building to another."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple, Protocol

from robotteamsim.control.driving.known_map import UNREACHABLE_M, KnownMap, known_map
from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.hazards import HazardField
from robotteamsim.interface import Decision, Task
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.levels import Traveller, Way, both_ways, level_at, places_at_end
from robotteamsim.scenario.problems import suggestion
from robotteamsim.setup import Setup
from robotteamsim.world.contract import AnyWorld
from robotteamsim.world.doors import DoorStates

_EQUAL_M = 1e-3
"""Paths whose lengths differ by less are equal: lengths are float32."""


class _WithField(Protocol):
    """What has fire and smoke as of the last update; None if nothing can burn."""

    @property
    def field(self) -> HazardField | None: ...


class _Trip(NamedTuple):
    """A robot on its way to a stop, where it arrives at a time."""

    way: Way
    arrival: int
    until_ns: int


class PassageStage:
    """The robots and firefighters on stairs, ramps and in lifts.

    A robot at a stop leaves it if the shortest way to its goal (`Decision.goal_m`) leads over this passage, or to its
    area if the stop itself is its goal, or if it was told to by `take`. It stands at the stop until the time of the way
    has passed, and is then at the other stop, or beside it if that is occupied. It goes back only after it has left
    that one.

    What robots believe is not known here: the shortest way is that of the plan, or that with doors and hot places as
    they are. Firefighters use the passages of people, at their walking speed or, with a victim, their escort speed.
    """

    def __init__(self, setup: Setup, world: AnyWorld, hazards: _WithField) -> None:
        plan = setup.scenario.plan
        self._hazards, self._at_start = hazards, DoorStates.at_start(plan)
        self._setup, self._world, self._levels = setup, world, plan.levels
        travellers: tuple[Traveller, ...] = ("robots", "people")
        self._ways = {by: both_ways(plan.levels, plan.passages, by) for by in travellers}
        self._travels_as = [setup.scenario.travels_as(robot_id) for robot_id in range(setup.scenario.team_size)]
        self._areas = [area.center for area in setup.scenario.mission.areas]
        self._trips: dict[int, _Trip] = {}
        self._came_by: dict[int, Way] = {}
        """Of robots that have not left the stop at which they have arrived."""
        self._told: dict[int, str] = {}
        self.elsewhere: Collection[int] = ()
        """Ids of robots that another world moves, and which are not taken here."""

    def take(self, robot_id: int, level: str) -> None:
        """Let a robot that is at a stop go to a level, or the next time that it is at a stop from which it can.

        Raises: ValueError: no such robot, it is absent or on this level, or no passage leads there.
        """
        is_number = isinstance(robot_id, int) and not isinstance(robot_id, bool)
        if not is_number or not 0 <= robot_id < self._world.num_robots or not self._world.present[robot_id]:
            raise ValueError(f"take_passage: robot {robot_id!r:.60} is not there")
        if robot_id in self.elsewhere:
            raise ValueError(f"take_passage: robot {robot_id} is moved by another world")
        served = self._setup.scenario.levels_of(robot_id)
        if level not in served:
            known = f"expected {' or '.join(served) or 'none'}{suggestion(str(level), served)}"
            raise ValueError(f"take_passage: there is no passage to level {level!r:.60}; {known}")
        here = level_at(self._levels, tuple(self._world.positions_m()[robot_id].tolist()))
        if here is not None and here.name == level:
            raise ValueError(f"take_passage: robot {robot_id} is on level {level} already")
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
            if robot_id in self.elsewhere:
                continue
            trip = self._trips.get(robot_id)
            if not world.present[robot_id] or (trip is not None and trip.arrival != world.arrivals[robot_id]):
                for known in (self._trips, self._told, self._came_by):
                    known.pop(robot_id, None)
            elif trip is None:
                way = self._taken(robot_id, (pose.x_m, pose.y_m), decisions[robot_id], task)
                if way is not None:
                    self._told.pop(robot_id, None)
                    until_ns = world.sim_time_ns + round(way.time_s(self._walking_mps(robot_id, task)) * 1e9)
                    self._trips[robot_id] = _Trip(way, world.arrivals[robot_id], until_ns)
            elif math.dist((pose.x_m, pose.y_m), trip.way.start) > 2.0 * trip.way.passage.radius_m:
                del self._trips[robot_id]  # moved elsewhere
            elif world.sim_time_ns >= trip.until_ns and self._arrives(robot_id, trip.way, pose):
                self._came_by[robot_id] = self._trips.pop(robot_id).way

    def _walking_mps(self, robot_id: int, task: Task) -> float | None:
        """Return how fast a firefighter walks on level floor [m/s]; None: a robot."""
        section = self._setup.scenario.firefighters
        if section is None or robot_id not in self._setup.scenario.firefighter_ids:
            return None
        escorts = any(one.robot_id == robot_id and one.moving for one in task.assistance)
        return min(section.escort_speed_mps, section.drive.max_speed_mps) if escorts else section.drive.max_speed_mps

    def _taken(self, robot_id: int, position: Point, decision: Decision, task: Task) -> Way | None:
        """Return the way that a robot takes from here; None: it stays."""
        came_by = self._came_by.get(robot_id)
        if came_by is not None and math.dist(came_by.end, position) > 2.0 * came_by.passage.radius_m:
            del self._came_by[robot_id]
        by = self._travels_as[robot_id]
        here = [way for way in self._ways[by] if math.dist(way.start, position) <= way.passage.radius_m]
        if not here:
            return None
        if told := self._told.get(robot_id):
            level = next(one for one in self._levels if one.name == told)
            if there := next((way for way in here if level.bounds.contains(way.end)), None):
                return there
        goal = decision.goal_m
        if goal is not None and math.dist(goal, here[0].start) <= 2.0 * here[0].passage.radius_m:
            goal = task.area_center_m if decision.area < 0 else self._areas[decision.area]
        if goal is None:
            return None
        for known in self._maps(robot_id, by):
            lengths_m = [way.equivalent_m(by) + known.distance_m(goal, way.end) for way in here]
            length_m, best = min(zip(lengths_m, here, strict=True), key=lambda pair: pair[0])
            is_shortest = length_m <= known.distance_m(goal, best.start) + _EQUAL_M
            goes_back = came_by is not None and best.end == came_by.start
            if is_shortest and length_m < UNREACHABLE_M and not goes_back:
                return best
        return None

    def _maps(self, robot_id: int, by: Traveller) -> Iterator[KnownMap]:
        """Yield the map of the plan and, where they differ, that with doors and hot places as they are."""
        building, reach_m = self._setup.building, self._setup.robots[robot_id].reach_m
        yield known_map(building, reach_m, by=by)
        doors = tuple(self._world.door_states().closed_since(self._at_start).items())
        field = self._hazards.field
        hot = () if field is None else field.hot_blocks(self._setup.scenario.hot_for_c(robot_id))
        if doors or hot:
            yield known_map(building, reach_m, doors, tuple(sorted(hot)), by=by)

    def _arrives(self, robot_id: int, way: Way, pose: Pose) -> bool:
        """Set a robot to the other stop of a way as it stood at this one, or beside it; whether there was room."""
        for x_m, y_m in places_at_end(way, (pose.x_m, pose.y_m)):
            try:
                self._world.set_pose(robot_id, Pose(x_m, y_m, pose.yaw_rad))
            except PlacementError:
                continue
            return True
        return False
