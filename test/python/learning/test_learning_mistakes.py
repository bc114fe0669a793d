"""What users of learning do wrong, and what is said of it."""

from __future__ import annotations

import numpy as np
import pytest
from gymnasium.spaces import MultiBinary

from robotteamsim.learning import (
    Act,
    BatchEnv,
    CentralEnv,
    DiscreteAct,
    LearningError,
    Memory,
    Observe,
    Reward,
    parallel_env,
)
from robotteamsim.scenario import load


def scenario(name="garage_sar", *overrides):
    return load(name, ["mission.time_limit_s=20", *overrides])


class Without(Reward):
    """A reward that is not a number."""

    def of_step(self, steps):
        return np.full((1, 3), np.nan)


class Blind(Observe):
    """An observation that is not a number."""

    def parts_of(self):
        return [("nothing", 1, "not a number")]

    def vectors(self, percepts):
        return np.full((1, 1, 1), np.nan, np.float32)


class Overdriven(Observe):
    """An observation with one number out of range, of the second robot of the second mission."""

    def vectors(self, percepts):
        vectors = super().vectors(percepts)
        vectors[1, 1, self.parts[2].begin + 1] = 1.5
        return vectors


class Listed(Observe):
    """An observation that is no array."""

    def vectors(self, percepts):
        return [[0.0]]


class Scalar(Reward):
    """One reward for all."""

    def of_step(self, steps):
        return 1.0


class Binary(Act):
    """Switches."""

    def __init__(self, *args):
        super().__init__(*args)
        self.space = MultiBinary(2)


class Nowhere(Act):
    """Commands that are not numbers."""

    def twists(self, actions):
        return np.full((len(actions), 3), np.nan)


class Negative(Observe):
    """A part of -1 numbers."""

    def parts_of(self):
        return [("nothing", -1, "cannot be")]


class Forgetful(Memory):
    """Remembers another number of numbers than it says."""

    def after(self, percepts, time_s):
        return np.zeros((len(percepts.poses), 1))


class WithForgetful(Observe):
    """What `Forgetful` does not have."""

    remembers = Forgetful


class Loud(Act):
    """Says what no message can have."""

    def say(self, actions):
        return 2.0 + super().say(actions)


def still(env):
    """Begin a mission and stand."""
    env.reset(seed=1)
    env.step({agent: np.zeros(env.action_space(agent).shape, np.float32) for agent in env.agents})


class Counting(Memory):
    """One number."""

    @classmethod
    def parts_of(cls, setup):
        return [("one", 1, "is 1")]

    def after(self, percepts, time_s):
        return np.ones((len(percepts.poses), 1))


class WithoutCounting(Observe):
    """An observation that leaves out what is remembered."""

    remembers = Counting

    def parts_of(self):
        return [("nothing", 1, "is 0")]

    def vectors(self, percepts):
        return np.zeros((*percepts.poses.shape[:-1], 1), np.float32)


@pytest.mark.parametrize(
    ("do", "message"),
    [
        (lambda env: env.step({}), "the mission has not begun; call reset first"),
        (
            lambda _: parallel_env("garage_unknown"),
            "garage_unknown.yaml: mission.area_order: nearest; expected given, because agents choose no areas",
        ),
        (lambda env: (env.reset(), env.step({})), "actions of nobody; expected robot_0, robot_1, robot_2"),
        (
            lambda env: (env.reset(), env.step(dict.fromkeys(env.agents, np.array((np.nan, 0.0))))),
            "robot_0: action array([nan,  0.]): expected one of Box(-1.0, 1.0, (2,), float32)",
        ),
        (
            lambda env: (env.reset(), env.step(dict.fromkeys(env.agents, np.array((1.5, 0.0))))),
            "robot_0: action array([1.5, 0. ]): expected one of Box(-1.0, 1.0, (2,), float32)",
        ),
        (lambda _: parallel_env("garage_sar", every=0), "every: 0; expected a whole number of at least 1"),
        (
            lambda _: parallel_env("garage_sar", render_mode="ansi"),
            "render_mode: 'ansi'; expected None, 'human' or 'rgb_array'",
        ),
        (
            lambda _: parallel_env("garage_sar", said=1, act=DiscreteAct),
            "said: 1; expected 0 with DiscreteAct",
        ),
        (
            lambda _: parallel_env(load("garage_rescue", ["robots.count=0", "relays.count=0"])),
            "--set: robots.count: no robot can be driven",
        ),
        (
            lambda _: parallel_env(load("garage_sar", ["robots.reserve=1"])),
            "garage_sar.yaml: robots: a robot arrives later; expected robots that are present from the start",
        ),
        (
            lambda env: (env.reset(), env.step(None)),
            "actions: None; expected an action by the name of each agent",
        ),
        (
            lambda env: (env.reset(), env.step({0: np.zeros(2)})),
            "actions of 0; expected robot_0, robot_1, robot_2",
        ),
        (
            lambda env: env.observation_space("nope"),
            "there is no agent 'nope'; expected one of robot_0, robot_1, robot_2",
        ),
        (lambda _: parallel_env("garage_sar", act=None), "act: None; expected a class derived from Act"),
        (
            lambda _: parallel_env(scenario(), reward=Without).reset(seed=1),
            "rewards[0, 0]: nan; expected finite numbers",
        ),
        (
            lambda _: parallel_env(scenario("tutorial_arena"), observe=Blind).reset(seed=1),
            "robot_0: observation: part nothing[0]: nan; expected a number within [-1, 1]",
        ),
        (
            lambda _: BatchEnv(scenario(), 2, observe=Overdriven).reset(1),
            "robot_1: observation: part twist[1]: 1.5; expected a number within [-1, 1]",
        ),
        (
            lambda _: parallel_env(scenario("tutorial_arena"), observe=Listed).reset(seed=1),
            "observations array([[0.]]), shape (1, 1); expected float32 within [-1, 1], shape (1, 1, 194)",
        ),
        (
            lambda _: parallel_env(scenario("tutorial_arena"), observe=WithoutCounting).reset(seed=1),
            "observations array([[[0.]]], dtype=float32), shape (1, 1, 1); "
            "expected float32 within [-1, 1], shape (1, 1, 2)",
        ),
        (
            lambda _: parallel_env(scenario("tutorial_arena"), observe=WithForgetful).reset(seed=1),
            "Forgetful.after: array([[0.]]), shape (1, 1); expected finite numbers, shape (1, 0)",
        ),
        (
            lambda _: still(parallel_env(scenario("tutorial_arena"), act=Loud, said=1)),
            "say: array([[2.]]); expected numbers within [-1, 1]",
        ),
        (lambda _: parallel_env(scenario(), act=Binary), "act: space MultiBinary(2); expected a Box or Discrete"),
        (
            lambda _: parallel_env(scenario(), reward=Scalar).reset(seed=1),
            "rewards: array(1.), shape (); expected finite numbers, shape (1, 3)",
        ),
        (
            lambda _: still(parallel_env(scenario("tutorial_arena"), act=Nowhere)),
            "twists[0, 0]: nan; expected finite numbers",
        ),
        (lambda _: parallel_env("garage_sar", every=True), "every: True; expected a whole number of at least 1"),
        (lambda _: parallel_env("garage_sar", every=None), "every: None; expected a whole number of at least 1"),
        (lambda env: env.action_space([1]), "there is no agent [1]; expected one of robot_0, robot_1, robot_2"),
        (
            lambda env: CentralEnv(env).reset(seed=-1),
            "seed: -1; expected a whole number from 0 to 9007199254740992",
        ),
        (
            lambda _: parallel_env(scenario(), observe=Negative),
            "part nothing: -1 numbers; expected a whole number from 0 to 1000000",
        ),
        (lambda env: env.reset(seed=-1), "seed: -1; expected a whole number from 0 to 9007199254740992"),
    ],
)
def test_wrong_use_is_one_line(do, message):
    env = parallel_env(scenario())
    with pytest.raises(LearningError) as raised:
        do(env)
    assert str(raised.value) == message
