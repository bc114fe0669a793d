"""Wandering at random: what an excluded robot does, and a controller that does nothing else."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim import rng
from robotteamsim.control.controller import Decision, Task
from robotteamsim.control.known_map import GRID_RESOLUTION_M, KnownMap, known_map
from robotteamsim.control.localisation import Localiser, body_of
from robotteamsim.control.navigation import Navigator
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import Observation
from robotteamsim.swarm import Vector

LONGEST_LEG_M = 8.0
SHORTEST_LEG_M = 1.0
ARRIVED_M = 0.3


class Wander:
    """Random straight legs over the known map: a new direction at the end of each, or when one takes too long."""

    def __init__(self, generator: np.random.Generator, speed_mps: float) -> None:
        self._rng = generator
        self._speed_mps = speed_mps
        self._goal: Vector | None = None
        self._until_s = 0.0

    def goal(self, free_space: KnownMap, position: Vector, time_s: float) -> Vector:
        """Return the end of the present leg, in `map` [m]."""
        if self._goal is None or time_s >= self._until_s or math.dist(position, self._goal) < ARRIVED_M:
            self._goal = self._next_goal(free_space, position)
            # Twice the time that the leg takes at full speed, and some for turning.
            self._until_s = time_s + 3.0 + 2.0 * math.dist(position, self._goal) / self._speed_mps
        return self._goal

    def stop(self) -> None:
        """Forget the present leg; the next call begins a new one."""
        self._goal = None

    def _next_goal(self, free_space: KnownMap, position: Vector) -> Vector:
        start = free_space.grid.nearest_free(position, 1.0) or position
        longest, longest_m = position, -1.0
        for _ in range(8):
            heading_rad, length_m = (self._rng.random(2) * (math.tau, LONGEST_LEG_M - SHORTEST_LEG_M)).tolist()
            end = free_end(free_space, start, heading_rad, length_m + SHORTEST_LEG_M)
            end_m = math.dist(start, end)
            if end_m > longest_m:
                longest, longest_m = end, end_m
            if end_m >= SHORTEST_LEG_M:
                break
        return longest


def free_end(free_space: KnownMap, start: Vector, heading_rad: float, length_m: float) -> Vector:
    """Return the farthest point in a direction, up to `length_m`, to which the straight way is free."""
    end = start
    for i in range(1, int(length_m / GRID_RESOLUTION_M) + 1):
        reach_m = i * GRID_RESOLUTION_M
        point = (start[0] + reach_m * math.cos(heading_rad), start[1] + reach_m * math.sin(heading_rad))
        if not free_space.grid.is_line_free(end, point):
            break
        end = point
    return end


class WanderController:
    """A random walk over the known map; it hears and says nothing."""

    def __init__(self, robot_id: int, scenario: Scenario) -> None:
        body = body_of(robot_id, scenario)
        self._localiser = Localiser(robot_id, scenario)
        self._map = known_map(scenario.plan, body.reach_m)
        self._navigator = Navigator(body, robot_id, scenario.control.navigation)
        self._speed_mps = scenario.control.max_step_speed_mps
        self._wander = Wander(rng.stream(scenario.run.seed, "wander", robot_id), self._speed_mps)
        self._observation: Observation | None = None
        self._task = Task()

    def observe(self, observation: Observation, inbox: Sequence[Message], task: Task) -> None:
        """Take in what the robot perceives."""
        self._observation, self._task = observation, task

    def decide(self) -> Decision:
        """Return the command towards the end of the present leg."""
        if self._observation is None or not self._task.running:
            return Decision()
        robot = self._observation.robot
        pose, time_s = self._localiser.map_T_base_link(robot), self._observation.sim_time_ns * 1e-9
        goal = self._wander.goal(self._map, (pose.x_m, pose.y_m), time_s)
        twist = self._navigator.drive(self._map, pose, robot.ranges_m, goal, self._speed_mps, time_s, {})
        return Decision(twist=twist, goal_m=goal)
