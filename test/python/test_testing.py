"""The checks that users call, on what the package has itself, and on parts with one mistake each."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from gymnasium.spaces import Box

import robotteamsim as rts
from robotteamsim.control.runtime.registry import algorithm_names
from robotteamsim.errors import ScenarioError
from robotteamsim.learning import TASKS, Act, DiscreteAct, Observe, Reward, task
from robotteamsim.scenario import load
from robotteamsim.testing import check_controller, check_env, check_sensor


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in algorithm_names() if ":" not in name])
def test_controllers_of_the_package_pass(name):
    check_controller(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", TASKS)
def test_tasks_of_the_package_pass(name):
    check_env(**task(name))


def test_other_actions_and_messages_pass():
    check_env("tutorial_arena", act=DiscreteAct, steps=10)
    check_env("garage_sar", said=2, teammates=1, every=2, steps=10)


class Ahead:
    """Drives ahead."""

    def __init__(self, robot_id, scenario):
        self.robot_id, self.scenario = robot_id, scenario

    def step(self, observation, inbox, task):
        return rts.Decision(self.twist(observation)) if task.running else rts.Decision()

    def twist(self, observation):
        return rts.Twist(0.1)


class Restless(Ahead):
    """Does not know of pauses."""

    def step(self, observation, inbox, task):
        return rts.Decision(rts.Twist(0.1))


class Chancy(Ahead):
    """Draws numbers that depend on no seed."""

    numbers = itertools.count()

    def twist(self, observation):
        return rts.Twist(0.001 * (next(self.numbers) % 100))


class Sharing(Ahead):
    """Lets robots of different missions know of each other."""

    last = None

    def twist(self, observation):
        before, Sharing.last = Sharing.last, self.scenario.run.seed
        return rts.Twist(0.1 if before in (None, Sharing.last) else 0.2)


class Trusting(Ahead):
    """Believes that all messages are numbers."""

    def twist(self, observation):
        return rts.Twist(0.0)

    def step(self, observation, inbox, task):
        for message in inbox:
            float(message.payload)
        return super().step(observation, inbox, task)


class Wild(Ahead):
    """Divides by zero in the end."""

    def twist(self, observation):
        return rts.Twist(np.inf if observation.sim_time_ns > 4 * 10**9 else 0.1)


class Counted(Ahead):
    """Cannot be made a second time."""

    def __init__(self, robot_id, scenario, arrival):
        super().__init__(robot_id, scenario)
        if arrival > 1:
            raise RuntimeError("once only")


@pytest.mark.parametrize(
    ("controller", "message"),
    [
        (Ahead, None),
        (Restless, "robot 0 moves while the mission is paused"),
        (Chancy, "robot 0, step 2: twist Twist.* in a second mission with the same seed, .* before"),
        (Sharing, "robot 0, step 3: twist Twist.* beside another team, .* before"),
        (Trusting, r"robot 0, step 1: ValueError: could not convert string to float: .* \(test_testing.py:\d+\)$"),
        (Wild, "robot 0, step 41: step returned Twist.*; expected a Twist of finite numbers"),
        (Counted, "robot 0, step 3: RuntimeError: once only"),
    ],
)
def test_controller_with_a_mistake_is_found(controller, message):
    if message is None:
        check_controller(controller, "tutorial_arena", ["robots.count=2"])
        return
    with pytest.raises(AssertionError, match=f"^test_testing:{controller.__name__}: {message}"):
        check_controller(controller, "tutorial_arena", ["robots.count=2"])


def test_what_cannot_be_checked_is_said():
    class Local(Ahead):
        pass

    with pytest.raises(ScenarioError, match=r"^check_controller: .*<locals>\.Local: expected a class of a module$"):
        check_controller(Local)
    with pytest.raises(ScenarioError, match=r"^check_controller: steps: 0; expected at least 1$"):
        check_controller(Ahead, steps=0)


class Brisk(Act):
    """Has a rest of its own, because 0 is no action."""

    def __init__(self, setup, robot_ids, said=0):
        super().__init__(setup, robot_ids, said)
        self.space = Box(0.1, 1.0, (2,), np.float32)

    @property
    def rest(self):
        return np.full(2, 0.1, np.float32)


def test_actions_without_zero_pass():
    check_env("tutorial_arena", act=Brisk, steps=5)


class Remembering(Reward):
    """Keeps something of the mission before."""

    def __init__(self, setup, robot_ids, missions=1):
        super().__init__(setup, robot_ids, missions)
        self.steps = np.zeros((missions, 1))

    def of_step(self, steps):
        self.steps[steps.missions] += 1.0
        return 0.001 * self.steps[steps.missions] + np.zeros(steps.contact.shape)


class OfAll(Reward):
    """Adds up missions."""

    def of_step(self, steps):
        return steps.positions_m.sum() * 1e-3 + np.zeros(steps.contact.shape)


class Drifting(Observe):
    """Depends on how often it was asked."""

    asked = itertools.count()

    def vectors(self, percepts):
        return super().vectors(percepts) * np.float32(1.0 / (1 + next(self.asked)))


@pytest.mark.parametrize(
    ("rules", "message"),
    [
        ({"reward": Remembering}, "robot_0, step 1: reward .* with the same seed in a second .*; see Reward.begin"),
        ({"reward": OfAll}, "robot_0, step 1: reward .* as the second mission of a batch, .* before"),
        (
            {"observe": Drifting},
            "robot_0, step 0: number .* of the observation is .* in a second environment, ",
        ),
    ],
)
def test_environment_with_a_mistake_is_found(rules, message):
    with pytest.raises(AssertionError, match=f"^{message}"):
        check_env(load("garage_sar"), steps=5, **rules)


@pytest.mark.parametrize(
    ("sensor", "scenario"),
    [
        ({"kind": "sonar", "name": "front"}, "garage_sar"),
        ({"kind": "gps", "name": "gps", "datum_lat_deg": 40.0, "datum_lon_deg": -8.0}, "tutorial_arena"),
        ({"kind": "laser", "name": "rear"}, "warehouse_push"),  # a list of robots
        ({"kind": "heat", "name": "heat"}, "garage_rescue"),
    ],
)
def test_our_sensors_pass_the_check(sensor, scenario):
    check_sensor(sensor, scenario, steps=20)
