"""A team that drives in a true world, with messages that always arrive one step later."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import msgspec
import pytest

from robotteamsim.control import make_controller
from robotteamsim.interface import Controller, Decision, Observation, Task
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.setup import resolve
from robotteamsim.world import World


def silence(position: tuple[float, float]) -> VoiceReading:
    return VoiceReading(0.0, False, position, 0.0)


class Team:
    """Steps world, sensors, network without loss, and controllers of a scenario, as the simulation does."""

    def __init__(self, scenario: Scenario) -> None:
        setup = resolve(scenario)
        robots = setup.robots
        self.world = World(scenario.plan, robots, scenario.run)
        self.controllers: list[Controller] = [make_controller(i, setup) for i in range(len(robots))]
        self.decisions = [Decision() for _ in robots]
        self.hear: Callable[[tuple[float, float]], VoiceReading] = silence
        """What a robot hears at a position."""
        self.hear_messages: list[Message] = []
        """What else arrives at every robot in each step."""
        area = scenario.mission.areas[0]
        self.task = Task(running=True, epoch=1, area_center_m=area.center, area_radius_m=area.radius_m)
        self._sensors = RobotSensors(self.world, robots, scenario.run.seed)

    def step(self) -> Sequence[Decision]:
        self.world.step([decision.twist for decision in self.decisions])
        readings = self._sensors.read()
        sent: list[Message] = [message for decision in self.decisions for message in decision.outbox]
        decisions = []
        for robot_id, (controller, reading) in enumerate(zip(self.controllers, readings, strict=True)):
            position = (reading.ground_truth.x_m, reading.ground_truth.y_m)
            observation = Observation(robot_id, self.world.sim_time_ns, reading, self.hear(position))
            inbox = [message for message in (*sent, *self.hear_messages) if message.sender != robot_id]
            decisions.append(controller.step(observation, inbox, self.task))
        self.decisions = decisions
        return self.decisions

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 1e9 / self.world.step_ns)):
            self.step()

    def new_epoch(self, **changes: object) -> None:
        self.task = msgspec.structs.replace(self.task, epoch=self.task.epoch + 1, **changes)


@pytest.fixture
def team() -> type[Team]:
    return Team
