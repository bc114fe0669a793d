"""The stage in which the team decides: the controllers of the scenario, or others in their place."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Protocol

import msgspec

from robotteamsim import _core
from robotteamsim.control import Guard, make_controller
from robotteamsim.control.driving.driver import Course
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Controller, Decision, Task
from robotteamsim.mission.sensed import Sensed
from robotteamsim.scenario import Scenario
from robotteamsim.setup import Setup


class Controllers(Protocol):
    """What decides for the team: the controllers in this process, or a shell to controllers elsewhere."""

    @property
    def faults(self) -> Sequence[str]:
        """Why each controller was stopped, or could not be made; "" while it works."""

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """Return the decision of each robot in id order; `Decision()` for an absent one."""


def check_constructed(controllers: Controllers, scenario: Scenario) -> None:
    """Raises: ScenarioError: a controller could not be constructed, so that its robot would stand still."""
    for robot_id, fault in enumerate(controllers.faults):
        if fault:
            raise ScenarioError(
                f"{scenario.name}: control.algorithm: '{scenario.control.algorithm}' cannot be constructed for robot "
                f"{robot_id}: {fault}"
            )


class TeamControllers:
    """The controllers of a scenario, in this process. A robot that arrives starts with a new one."""

    def __init__(self, setup: Setup) -> None:
        """Make the controllers. Raises: RobotTeamSimError: the user's mistake, such as an unknown controller."""
        self._setup, robots = setup, range(len(setup.robots))
        self._arrivals: Sequence[int] = (1,) * len(robots)
        self.guards = [self._guard(robot_id, 1) for robot_id in robots]
        """The controllers in robot id order."""
        self._courses: list[Course | None] = [None for _ in robots]
        """How robots drive on without their controllers."""
        self._decisions = [Decision() for _ in robots]
        self._task = Task()

    @property
    def faults(self) -> Sequence[str]:
        """As for all controllers."""
        return [guard.fault for guard in self.guards]

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        if sensed.arrivals != self._arrivals:
            self._make_arrived(sensed.arrivals)
        time_ns, is_task_new, driving = sensed.sim_time_ns, sensed.task != self._task, []
        self._task = sensed.task
        asked: list[int] = []
        for i, (course, inbox, is_present) in enumerate(
            zip(self._courses, sensed.inboxes, sensed.present.tolist(), strict=True)
        ):
            if not is_present:
                self._courses[i], self._decisions[i] = None, Decision()
            elif course is None or inbox or time_ns >= course.until_ns or is_task_new:
                asked.append(i)
            else:
                driving.append(course)
        # Most of a team is asked, or hardly anybody.
        observations = sensed.observations() if 2 * len(asked) > len(self.guards) else None
        for i in asked:
            observation = sensed.observation(i) if observations is None else observations[i]
            self._decisions[i] = self.guards[i].step(observation, sensed.inboxes[i], sensed.task)
            self._courses[i] = self.guards[i].course
        twists = _core.control.drive_team(sensed.state, driving, time_ns) if driving else ()
        for course, twist in zip(driving, twists, strict=True):
            before = self._decisions[course.robot_id]
            self._decisions[course.robot_id] = msgspec.structs.replace(before, twist=twist, outbox=())
        return tuple(self._decisions)

    def _make_arrived(self, arrivals: Sequence[int]) -> None:
        for robot_id, (before, count) in enumerate(zip(self._arrivals, arrivals, strict=True)):
            if count > before:
                self.guards[robot_id], self._courses[robot_id] = self._guard(robot_id, count), None
        self._arrivals = arrivals

    def _guard(self, robot_id: int, arrival: int) -> Guard:
        return Guard(robot_id, len(self._setup.robots), partial(self._controller, robot_id, arrival))

    def _controller(self, robot_id: int, arrival: int) -> Controller:
        """Make the controller of a robot. Args: arrival: how often it has arrived."""
        return make_controller(robot_id, self._setup, arrival)
