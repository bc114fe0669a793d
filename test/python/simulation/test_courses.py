"""Robots that drive on without their controllers, against those whose controllers are called in each step."""

from __future__ import annotations

import pytest

from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.runtime.guard import Guard
from robotteamsim.geometry import Twist
from robotteamsim.interface import Decision
from robotteamsim.scenario import load
from robotteamsim.simulation import Observer, Simulation, TrajectoryHash


class Decisions(Observer):
    """Keeps what the team decides in each step."""

    def __init__(self):
        self.made, self.hash = [], TrajectoryHash()

    def step(self, record):
        self.made.append(tuple(record.decisions))
        self.hash.update(record.sim_time_ns, record.state.true_pose)


def decisions_of(*overrides):
    kept = Decisions()
    Simulation(load("garage_sar", ["mission.time_limit_s=40", *overrides])).run([kept])
    return kept


@pytest.mark.parametrize(
    "overrides",
    [
        (),
        ("control.localisation=odometry",),
        ("control.adaptation=crisp", "robots.count=5"),
        ("schedule=[{at_s: 8.05, remove: 1}, {at_s: 20.0, spawn: 1}]",),
    ],
)
def test_team_decides_the_same_without_calls_between_iterations(overrides, monkeypatch):
    calls = []
    step = RdpsoController.step
    monkeypatch.setattr(RdpsoController, "step", lambda *given: calls.append(given) or step(*given))
    driven, few = decisions_of(*overrides), len(calls)
    monkeypatch.setattr(Guard, "course", None)
    called = decisions_of(*overrides)
    assert driven.made == called.made
    assert driven.hash.hexdigest() == called.hash.hexdigest()
    if "odometry" not in str(overrides):
        assert few < 0.5 * (len(calls) - few)


def test_controller_with_a_step_of_its_own_is_called_in_each_step():
    calls = []

    class Counting(RdpsoController):
        def step(self, observation, inbox, task):
            calls.append(observation.robot_id)
            return super().step(observation, inbox, task)

    step_with(Counting)
    assert len(calls) == 150


def step_with(make):
    simulation = Simulation(load("garage_sar"))
    simulation.mission.start()
    for robot_id, guard in enumerate(simulation.controllers.guards):
        guard.controller = make(robot_id, simulation.setup)
    for _ in range(50):
        record = simulation.step()
    assert [decision.fault for decision in record.decisions] == [""] * 3


def test_controller_in_another_one_is_called_in_each_step():
    calls = []

    class Wrapped:
        """Has all attributes of the controller in it."""

        def __init__(self, robot_id, setup):
            self._inner = RdpsoController(robot_id, setup)

        def __getattr__(self, name):
            return getattr(self._inner, name)

        def step(self, observation, inbox, task):
            calls.append(observation.robot_id)
            return self._inner.step(observation, inbox, task)

    step_with(Wrapped)
    assert len(calls) == 150


def test_step_that_is_put_into_a_controller_is_called_in_each_step():
    calls = []

    def patched(robot_id, setup):
        controller = RdpsoController(robot_id, setup)
        step = controller.step
        controller.step = lambda *given: calls.append(robot_id) or step(*given)
        return controller

    step_with(patched)
    assert len(calls) == 150


def test_controller_may_call_its_heading_a_course():
    class Sailor:
        def __init__(self, robot_id, setup):
            self.course = 0.3

        def step(self, observation, inbox, task):
            return Decision(Twist(0.1))

    step_with(Sailor)
