"""The robots that viewers of a live mission drive by hand, in place of their controllers."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from robotteamsim.control.driving.driver import Driver
from robotteamsim.geometry import Twist
from robotteamsim.interface import Observation
from robotteamsim.scenario.base import Point
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.world.doors import DoorStates

_NEAR_M = 1.0
"""Greatest distance from a goal to floor where the robot fits."""


class DrivenRobots:
    """Robots that drive as a viewer says, or to a goal as their controllers would, until released or absent."""

    def __init__(self, simulation: Simulation) -> None:
        """Drive none yet."""
        self._simulation, self._setup = simulation, simulation.setup
        self._plan_doors = DoorStates.at_start(simulation.setup.plan)
        self._twist_of: dict[int, Callable[[StepRecord], Twist]] = {}
        self.goals: dict[int, Point | None] = {}
        """Of all driven robots, by id [m, map]; None: it has none."""

    def drive(self, robot_id: int, forward: float, turn: float) -> None:
        """Drive a robot from now on, at shares of its greatest speeds. Raises: ValueError: no such robot, or absent."""
        self._check(robot_id)
        limits = self._setup.robots[robot_id].drive
        twist = Twist(forward * limits.max_speed_mps, 0.0, turn * limits.max_turn_radps)
        self.goals[robot_id], self._twist_of[robot_id] = None, lambda _: twist

    def set_goal(self, robot_id: int, goal_m: Point) -> None:
        """Let a robot drive to a goal, and wait there. Raises: ValueError: no such robot, absent, or no floor there."""
        self._check(robot_id)
        driver = Driver(robot_id, self._setup)
        if driver.map.grid.nearest_free(goal_m, _NEAR_M) is None:
            place = f"({goal_m[0]:g}, {goal_m[1]:g})"
            raise ValueError(f"set_goal: position_m: {place}: no floor for robot {robot_id} within {_NEAR_M:g} m")
        self.goals[robot_id], self._twist_of[robot_id] = goal_m, partial(self._to_goal, robot_id, driver, goal_m)

    def release(self, robot_id: int) -> None:
        """Leave a robot, at rest, to its controller. Raises: ValueError: no such robot, or it is absent."""
        self._check(robot_id)
        if robot_id in self.goals:
            del self.goals[robot_id]
            self._simulation.command({robot_id: Twist()})

    def command(self, last: StepRecord) -> None:
        """Let them move in the next step. Args: last: the record of the step before."""
        present = self._simulation.world.present
        self.goals = {robot_id: goal_m for robot_id, goal_m in self.goals.items() if present[robot_id]}
        if self.goals:
            self._simulation.command({robot_id: self._twist_of[robot_id](last) for robot_id in self.goals})

    def _check(self, robot_id: int) -> None:
        present = self._simulation.world.present
        if robot_id not in range(len(present)):
            raise ValueError(f"there is no robot {robot_id}, only 0 to {len(present) - 1}")
        if not present[robot_id]:
            raise ValueError(f"robot {robot_id} is absent")

    def _to_goal(self, robot_id: int, driver: Driver, goal_m: Point, last: StepRecord) -> Twist:
        """Return the command of a robot that drives by what it sensed; doors are known as they are."""
        world = self._simulation.world
        if not last.is_there(robot_id):
            return Twist()
        now = Observation(robot_id, last.sim_time_ns, last.readings[robot_id], last.voices[robot_id])
        driver.hot.look(now.robot)
        driver.update_map(last.sim_time_ns, tuple(world.door_states().closed_since(self._plan_doors).items()))
        others = {i: (pose.x_m, pose.y_m) for i, pose in enumerate(world.poses()) if i != robot_id and world.present[i]}
        speed_mps = self._setup.robots[robot_id].drive.max_speed_mps
        return driver.drive(now, now.pose, goal_m, speed_mps, lambda: others)
