"""The robots that viewers of a live mission drive by hand, in place of their controllers."""

from __future__ import annotations

from robotteamsim.control.driving.driver import Driver
from robotteamsim.geometry import Twist
from robotteamsim.interface import Observation
from robotteamsim.scenario.base import Point
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.world.doors import DoorStates

NEAR_M = 1.0  # from a goal to floor where the robot fits


class DrivenRobots:
    """Robots that drive as a viewer says, or to a goal as their controllers would, until released or absent."""

    def __init__(self, simulation: Simulation) -> None:
        """Drive none yet."""
        self._simulation, self._setup = simulation, simulation.setup
        self._plan_doors = DoorStates.at_start(simulation.setup.plan)
        self._twists: dict[int, Twist] = {}
        self._drivers: dict[int, Driver] = {}
        self.goals: dict[int, Point | None] = {}
        """Of all driven robots, by id [m, map]; None: it has none."""

    def drive(self, robot_id: int, forward: float, turn: float) -> None:
        """Drive a robot from now on, at shares of its greatest speeds. Raises: ValueError: no such robot, or absent."""
        self.release(robot_id)
        limits = self._setup.robots[robot_id].drive
        self.goals[robot_id] = None
        self._twists[robot_id] = Twist(forward * limits.max_speed_mps, 0.0, turn * limits.max_turn_radps)

    def go(self, robot_id: int, goal_m: Point) -> None:
        """Let a robot drive to a goal, and wait there. Raises: ValueError: no such robot, absent, or no floor there."""
        self.release(robot_id)
        driver = Driver(robot_id, self._setup)
        if driver.map.grid.nearest_free(goal_m, NEAR_M) is None:
            place = f"({goal_m[0]:g}, {goal_m[1]:g})"
            raise ValueError(f"set_goal: position_m: {place}: no floor for robot {robot_id} within {NEAR_M:g} m")
        self.goals[robot_id], self._drivers[robot_id] = goal_m, driver

    def release(self, robot_id: int) -> None:
        """Leave a robot, at rest, to its controller. Raises: ValueError: no such robot, or it is absent."""
        self._simulation.command({robot_id: Twist()})
        if not self._simulation.world.present[robot_id]:
            raise ValueError(f"robot {robot_id} is absent")
        self.goals.pop(robot_id, None)

    def command(self, last: StepRecord) -> None:
        """Let them move in the next step. Args: last: the record of the step before."""
        present = self._simulation.world.present
        self.goals = {robot_id: goal_m for robot_id, goal_m in self.goals.items() if present[robot_id]}
        if self.goals:
            self._simulation.command(
                {robot_id: self._twist(robot_id, goal, last) for robot_id, goal in self.goals.items()}
            )

    def _twist(self, robot_id: int, goal_m: Point | None, last: StepRecord) -> Twist:
        """Return the command of a robot. To a goal it drives by what it sensed; doors are known as they are."""
        if goal_m is None:
            return self._twists[robot_id]
        if not last.is_there(robot_id):
            return Twist()
        driver, world = self._drivers[robot_id], self._simulation.world
        now = Observation(robot_id, last.sim_time_ns, last.readings[robot_id], last.voices[robot_id])
        driver.hot.look(now.robot)
        driver.update_map(last.sim_time_ns, tuple(world.door_states().closed_since(self._plan_doors).items()))
        others = {i: (pose.x_m, pose.y_m) for i, pose in enumerate(world.poses()) if i != robot_id and world.present[i]}
        speed_mps = self._setup.robots[robot_id].drive.max_speed_mps
        return driver.drive(now, driver.pose(now), goal_m, speed_mps, lambda: others)
