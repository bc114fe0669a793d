"""What a robot needs in order to drive: the map that it knows, and the way to a point."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from robotteamsim import _core
from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import Disc, KnownMap, known_map
from robotteamsim.control.driving.navigation import Navigator
from robotteamsim.control.driving.places import OtherPlaces, Places
from robotteamsim.geometry import Pose, Twist
from robotteamsim.interface import Observation, Task
from robotteamsim.scenario.building import Doors
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


class Course(NamedTuple):
    """How a robot drives until its controller decides again: at a time, with a message, or when the task changes."""

    robot_id: int
    navigator: Navigator
    grid: _core.plan.PlanningGrid
    goal_m: Vector
    speed_mps: float
    teammates: Callable[[], _core.control.Places]
    until_ns: int


class DrivesOn:
    """Base class of a controller that need not be called in each step.

    Where it runs in one process with its team, and `course` is not None after a step, the team is driven in one call
    until then, to the same bits.
    """

    course: Course | None = None


class Driver:
    """Drives one robot over the map that it knows; places in `map` [m]."""

    def __init__(self, robot_id: int, setup: Setup) -> None:
        body, control = setup.robots[robot_id], setup.scenario.control
        self._robot_id = robot_id
        self._looks = bool(body.sensors)
        """Whether it needs the readings of each step, of a thermal camera."""
        self._building, self._reach_m = setup.map_of(robot_id), body.reach_m
        self._by = setup.scenario.travels_as(robot_id)
        self._navigator = Navigator(body, robot_id, control.navigation, control.navigator)
        self.hot = HotPlaces(setup.scenario.plan, setup.scenario.hot_for_c(robot_id))
        """The hot places that it knows."""
        self.doors: Doors = ()
        """The doors that differ from the plan in `map`."""
        self._kept_out: Disc | None = None
        self._version = self._building.version
        self.map = known_map(self._building, body.reach_m, by=self._by)
        """Free space, with doors and hot places as believed at the last update."""

    def update_map(self, sim_time_ns: int, doors: Doors = (), kept_out: Disc | None = None) -> bool:
        """Use the map with walls, doors and hot places as believed now; return whether it has changed.

        Args: kept_out: a disc that paths do not enter.
        """
        now = doors, kept_out, self._building.version
        if not self.hot.update(sim_time_ns) and now == (self.doors, self._kept_out, self._version):
            return False
        self.doors, self._kept_out, self._version = now
        self.map = self.map_outside(kept_out)
        return True

    def map_outside(self, kept_out: Disc | None) -> KnownMap:
        """Return the map as of the last update, but with another disc that paths do not enter; None: without one."""
        return known_map(self._building, self._reach_m, self.doors, self.hot.blocked, kept_out, self._by)

    def closed_area(self, task: Task, position: Vector) -> Vector | None:
        """Return the centre of the area of the task if the robot knows no path to its floor; None if it knows one."""
        center, start = task.area_center_m, self.map.grid.nearest_free(position, 1.0)
        if center is None or start is None or self.map.reaches(start, center, task.area_radius_m):
            return None
        return center

    def way_out(self, position: Vector) -> Vector | None:
        """Return where a robot that heat surrounds leaves to; None if it does not."""
        return self.hot.way_out(self.map.grid, position)

    def shelter(self, position: Vector) -> Vector | None:
        """Return where a robot that stands in a hot place leaves to; None if it does not."""
        return self.hot.shelter(self.map.grid, position)

    def drive(
        self,
        observation: Observation,
        pose: Pose,
        goal: Vector,
        speed_mps: float,
        teammates: Callable[[], Mapping[int, Vector]],
    ) -> Twist:
        """Return the command of a step, see `Navigator`.

        Args: teammates: returns the last known positions of other robots, in `map` [m], by id.
        """
        ranges_m, sim_time_ns, others = observation.robot.ranges_m, observation.sim_time_ns, places_of(teammates)
        return self._navigator.drive(self.map.grid, pose, ranges_m, goal, speed_mps, sim_time_ns, others)

    def course(
        self, goal: Vector, speed_mps: float, teammates: Callable[[], Mapping[int, Vector]], until_ns: int
    ) -> Course | None:
        """Return how the robot drives on, if that depends on no more than its true pose and its laser; see `drive`."""
        if self._looks or self.hot.known:
            return None
        others = places_of(teammates)
        return Course(self._robot_id, self._navigator, self.map.grid, goal, speed_mps, others, until_ns)


def places_of(teammates: Callable[[], Mapping[int, Vector]]) -> Callable[[], _core.control.Places]:
    """Return a function that returns the teammates as `Navigator` takes them.

    Those of `OtherPlaces` are shared, and have the robot itself, too, which its navigator leaves out.
    """

    def places() -> _core.control.Places:
        others = teammates()
        known = others.places if isinstance(others, OtherPlaces) else Places(dict(sorted(others.items())))
        return known.core

    return places
