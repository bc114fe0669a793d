"""Missions as environments, against the tests of PettingZoo and Gymnasium, and against the simulation itself."""

from __future__ import annotations

import copy
import pickle
import sys
from types import ModuleType, SimpleNamespace

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Discrete
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import max_cycles_test, parallel_api_test, parallel_seed_test, state_test

from robotteamsim import learning, palette
from robotteamsim.learning import (
    Act,
    CentralEnv,
    DiscreteAct,
    LearningError,
    Memory,
    Observe,
    PolicyController,
    Reward,
    gym_env,
    parallel_env,
)
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation, TrajectoryHash

SHORT = "mission.time_limit_s=20"


def scenario(name="garage_sar", *overrides):
    return load(name, [SHORT, *overrides])


def driven_to(env, seed, choose):
    """Return rewards and hash of a mission in which agents choose by their observations."""
    found = TrajectoryHash()
    vectors, _ = env.reset(seed=seed)
    total = 0.0
    while env.agents:
        vectors, rewards, *_ = env.step({agent: choose(vectors[agent]) for agent in env.agents})
        total += sum(rewards.values())
        found.update(env.record.sim_time_ns, env.record.state.true_pose)
    return total, found.hexdigest()


def wall_fearing(vector):
    """A policy of the laser alone: away from what is near."""
    right, ahead, left = vector[:60].min(), vector[60:121].min(), vector[121:181].min()
    return np.array((ahead, np.clip(left - right, -1.0, 1.0)), np.float32)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("garage_sar", {}),
        ("garage_sar", {"said": 2, "every": 1}),
        ("tutorial_arena", {"act": DiscreteAct}),
        ("office_manet", {}),
        ("warehouse_push", {}),
        ("garage_fire", {}),
    ],
)
def test_is_a_parallel_env_of_pettingzoo(name, settings):
    def make():
        return parallel_env(scenario(name), **settings)

    parallel_api_test(make(), num_cycles=60)
    parallel_seed_test(make, num_cycles=20)
    state_test(learning.env(scenario(name), **settings), make())


@pytest.mark.slow
def test_is_truncated_after_some_cycles():
    def parallel_env_of_test(max_cycles):
        return parallel_env(scenario(), max_cycles=max_cycles)

    def env_of_test(max_cycles):
        return learning.env(scenario(), max_cycles=max_cycles)

    max_cycles_test(SimpleNamespace(parallel_env=parallel_env_of_test, env=env_of_test))


@pytest.mark.slow
def test_is_drawn():
    env = parallel_env(scenario(), render_mode="rgb_array")
    env.reset(seed=1)
    picture = env.render()
    assert picture.dtype == np.uint8
    assert picture.shape[2] == 3
    colours = set(map(tuple, np.unique(picture.reshape(-1, 3), axis=0).tolist()))
    shown = (*(palette.robot_colour(i) for i in range(3)), palette.OPEN_AREA, palette.WAITING)
    assert {tuple(round(255 * part) for part in palette.rgb(code)) for code in shown} <= colours
    assert parallel_env(scenario()).render() is None


@pytest.mark.slow
@pytest.mark.parametrize("settings", [{}, {"act": DiscreteAct}])
def test_is_an_env_of_gymnasium(settings):
    check_env(gym_env(scenario(), **settings), skip_render_check=True)


def test_a_step_after_the_end_is_refused():
    env = gym_env(scenario(), max_cycles=1)
    env.reset(seed=1)
    *_, truncated, _ = env.step(env.action_space.sample())
    assert truncated
    with pytest.raises(LearningError, match=r"^step: no mission is under way"):
        env.step(env.action_space.sample())


def test_is_registered_with_gymnasium():
    env = gymnasium.make("robotteamsim/GarageSearch-v0")
    vector, _ = env.reset(seed=1)
    assert vector.shape == (3 * (181 + 13 + 2 * 5),)


@pytest.mark.slow
def test_policy_drives_as_in_training(monkeypatch):
    vectors = []

    class Policy(PolicyController):
        def choose(self, vector):
            vectors.append(vector)
            return wall_fearing(vector)

    module = ModuleType("policy_of_test")
    module.Policy = Policy
    monkeypatch.setitem(sys.modules, "policy_of_test", module)
    trained = []

    def choose(vector):
        trained.append(vector)
        return wall_fearing(vector)

    env = parallel_env(scenario(), every=5)
    driven_to(env, 11, choose)
    end = env.record
    simulation = Simulation(scenario("garage_sar", "run.seed=11", "control.algorithm=policy_of_test:Policy"))
    simulation.run()
    np.testing.assert_array_equal(np.array(vectors), np.array(trained))
    # The environment senses once more after the end.
    assert simulation.world.step_index == end.step_index
    assert np.array_equal(simulation.mission.status.time_s, end.mission.time_s)


@pytest.mark.slow
def test_policy_with_room_for_two_teammates_drives_a_larger_team(monkeypatch):
    class Policy(PolicyController):
        teammates = 2

        def choose(self, vector):
            return wall_fearing(vector)

    module = ModuleType("policy_of_test")
    module.Policy = Policy
    monkeypatch.setitem(sys.modules, "policy_of_test", module)
    made = scenario("garage_sar", "robots.count=8", "control.algorithm=policy_of_test:Policy")
    simulation = Simulation(made)
    simulation.run()
    assert not any(simulation.controllers.faults)
    env = parallel_env(made, teammates=2)
    driven_to(env, made.run.seed, wall_fearing)
    assert np.array_equal(simulation.mission.status.time_s, env.record.mission.time_s)
    vectors, _ = env.reset(seed=1)
    vectors, *_ = env.step(dict.fromkeys(env.agents, np.zeros(2, np.float32)))
    begins = [part.begin for part in env.parts if part.name.startswith("teammate_")]
    assert all(vectors["robot_7"][begin] == 1.0 for begin in begins)
    assert len(begins) == 2


@pytest.mark.slow
def test_same_seed_has_the_same_bits_and_another_one_others():
    env = parallel_env(scenario("garage_sar", "robots.formation=random"))
    first = driven_to(env, 3, wall_fearing)
    assert driven_to(env, 3, wall_fearing) == first
    assert driven_to(env, 4, wall_fearing)[1] != first[1]


def test_odometry_begins_where_the_seed_places_the_robot():
    settings = ["robots.formation=random", "control.localisation=odometry"]
    env = parallel_env(load("garage_sar", settings))
    for seed in (3, 4):
        vectors, _ = env.reset(seed=seed)
        x_m, y_m = env.record.state.positions_m[0]
        expected = (2.0 * x_m / 60.0 - 1.0, 2.0 * y_m / 40.0 - 1.0)
        assert vectors["robot_0"][181:183].tolist() == pytest.approx(expected, abs=1e-6)


def test_reward_is_for_areas_victims_and_the_way_there():
    env = parallel_env(load("garage_sar", ["mission.areas.0.center=[10, 5]"]))
    env.reset(seed=1)
    ahead = np.array((1.0, 0.0), np.float32)
    won = []
    while env.record.mission.areas_explored == 0:
        _, rewards, *_ = env.step(dict.fromkeys(env.agents, ahead))
        won.append(rewards)
    driven_m = env.record.state.positions_m[:, 0].max() - 4.4
    for agent in env.agents:
        assert sum(rewards[agent] for rewards in won[1:-1]) == pytest.approx(0.02 * driven_m, abs=0.02)
        assert won[-1][agent] == pytest.approx(1.0, abs=0.02)


def test_classes_are_replaced():
    class Nothing(Reward):
        pass

    class Slow(Act):
        def twists(self, actions):
            return super().twists(0.1 * actions)

    env = parallel_env(scenario(), act=Slow, reward=Nothing)
    env.reset(seed=1)
    ahead = np.array((1.0, 0.0), np.float32)
    for _ in range(4):
        _, rewards, *_ = env.step(dict.fromkeys(env.agents, ahead))
    assert set(rewards.values()) == {0.0}
    assert env.record.state.true_twist[0, 0] == pytest.approx(0.07)


def test_what_is_said_is_heard_over_the_network():
    env = parallel_env(scenario(), said=2)
    env.reset(seed=1)
    actions = {agent: np.array((0.0, 0.0, 0.25, -0.5), np.float32) for agent in env.agents}
    vectors, *_ = env.step(actions)
    parts = {part.name: part for part in env.parts}
    heard = vectors["robot_0"][parts["teammate_0"].begin :][: parts["teammate_0"].size]
    assert heard[0] == 1.0
    assert heard[-2:].tolist() == [0.25, -0.5]
    assert 0.5 < heard[3] <= 1.0  # a metre away
    assert parts["teammate_1"].begin + parts["teammate_1"].size == len(vectors["robot_0"])


class SonarMemory(Memory):
    """The last range of the sonar at the front."""

    looks = True

    @classmethod
    def parts_of(cls, setup):
        return [("sonar", 1, "its range / 3 m")]

    def look(self, readings):
        self.ranges_m = [reading.sensors.get("front", 3.0) for reading in readings]

    def after(self, percepts, time_s):
        return np.array(self.ranges_m)[:, None] / 3.0


class WithSonar(Observe):
    """The sonar at the front, in addition."""

    remembers = SonarMemory


def test_additional_sensors_are_remembered_also_where_a_robot_has_left():
    changes = "robots.sensors=[{kind: sonar, name: front}]", "schedule=[{at_s: 0.5, remove: 1}]"
    env = parallel_env(scenario("garage_sar", *changes), observe=WithSonar)
    vectors, _ = env.reset(seed=1)
    sonars_m = [reading.sensors["front"] for reading in env.record.readings]
    assert [vector[-1] for vector in vectors.values()] == pytest.approx([range_m / 3.0 for range_m in sonars_m])
    for _ in range(2):
        vectors, *_ = env.step(dict.fromkeys(env.agents, np.zeros(2, np.float32)))
    assert vectors.keys() == {"robot_0", "robot_2"}


class Turns(Act):
    """Two actions: to the left, to the right. It handles the agents of one mission only."""

    def __init__(self, *args):
        super().__init__(*args)
        self.space = Discrete(2)

    def twists(self, actions):
        return np.array([(0.0, 0.0, 1.0 - 2.0 * int(action)) for action in actions])


class Yes(Act):
    """Says yes."""

    def say(self, actions):
        return np.ones((*actions.shape[:-1], 1), bool)


class Odd(Act):
    """Whole numbers in two rows."""

    def __init__(self, *args):
        super().__init__(*args)
        self.space = Box(0, 3, (2, 3), np.int64)

    def twists(self, actions):
        return np.zeros((*actions.shape[:-2], 3))


def test_truth_values_that_are_said_are_heard_as_numbers():
    env = parallel_env(scenario(), act=Yes, said=1)
    env.reset(seed=1)
    for _ in range(3):
        vectors, *_ = env.step({agent: np.zeros(3, np.float32) for agent in env.agents})
    part = next(part for part in env.parts if part.name == "teammate_0")
    assert vectors["robot_0"][part.begin] == vectors["robot_0"][part.begin + part.size - 1] == 1.0


def test_joint_space_keeps_kind_and_number_of_own_actions():
    env = CentralEnv(parallel_env(scenario(), act=Odd))
    env.reset(seed=1)
    assert (env.action_space.shape, env.action_space.dtype) == ((18,), np.int64)
    env.action_space.seed(1)
    env.step(env.action_space.sample())


def test_own_discrete_actions_need_say_nothing():
    env = parallel_env(scenario(), act=Turns)
    env.reset(seed=1)
    env.step(dict.fromkeys(env.agents, 1))
    assert env.record.state.true_twist[0, 2] < 0.0


def test_robots_of_other_kinds_have_the_same_spaces():
    env = parallel_env(scenario("warehouse_push"))  # the second robot is omnidirectional, with 361 beams
    vectors, _ = env.reset(seed=1)
    assert all(env.observation_space(agent).contains(vectors[agent]) for agent in env.agents)
    assert (vectors["robot_0"][181:361] == 1.0).all()
    assert not (vectors["robot_1"][181:361] == 1.0).all()
    left = np.array((0.0, 1.0, 0.0), np.float32)
    for _ in range(3):
        env.step(dict.fromkeys(env.agents, left))
    speeds_mps = env.record.state.true_twist[:, 1]
    assert speeds_mps[1] > 0.3
    assert speeds_mps[[0, 2]].tolist() == [0.0, 0.0]


def test_numbers_of_numpy_are_whole_numbers_too():
    assert parallel_env(scenario(), every=np.int64(3), max_cycles=np.int32(2)).reset(seed=1)


def test_robot_that_leaves_is_terminated_and_the_others_go_on():
    env = parallel_env(scenario("garage_sar", "schedule=[{at_s: 2.0, remove: 1}]"))
    env.reset(seed=1)
    stand = np.zeros(2, np.float32)
    left = []
    for _ in range(8):
        _, _, terminated, truncated, _ = env.step(dict.fromkeys(env.agents, stand))
        left += [agent for agent, over in terminated.items() if over]
        assert not any(truncated.values())
    assert left == ["robot_1"]
    assert env.agents == ["robot_0", "robot_2"]


def test_base_and_relays_are_no_agents():
    assert parallel_env(load("office_manet")).possible_agents == [f"robot_{i}" for i in range(1, 9)]
    rescue = load("garage_rescue")
    agents = parallel_env(rescue).possible_agents
    assert len(agents) == rescue.num_robots - rescue.relays.count > 0


def test_base_acknowledges_as_without_an_environment():
    near = "{name: near, center: [6, 4], radius_m: 50}"
    env = parallel_env(
        load("office_manet", [f"mission.areas=[{near}, {{name: far, center: [40, 20], radius_m: 0.1}}]"])
    )
    env.reset(seed=1)
    for _ in range(4):
        env.step({agent: np.zeros(2, np.float32) for agent in env.agents})
    assert env.record.mission.delivered.count >= 1


def test_actions_of_another_kind_are_rejected():
    env = parallel_env(scenario(), act=DiscreteAct)
    env.reset(seed=1)
    for action in (2.7, "left", None, [[1], [1, 2]]):
        with pytest.raises(LearningError, match=r"^robot_0: action "):
            env.step(dict.fromkeys(env.agents, action))
    env = parallel_env(scenario())
    env.reset(seed=1)
    with pytest.raises(LearningError, match=r"^robot_0: action masked_array"):
        env.step(dict.fromkeys(env.agents, np.ma.array([0.0, 0.0], mask=[True, False])))


def test_spaces_stay_the_same():
    env = parallel_env(scenario())
    space = env.action_space("robot_0")
    env.reset(seed=1)
    assert env.action_space("robot_0") is space


LEAVES = "schedule=[{at_s: 1.0, remove: 1}]"
"""robot_1 leaves in the second step of agents."""


def test_actions_of_agents_that_left_are_ignored():
    # TorchRL 0.14, skrl 2.1 and AgileRL 2.58 go on to send them.
    env = parallel_env(scenario("garage_sar", LEAVES), max_cycles=4)
    env.reset(seed=7)
    present = []
    while env.agents:
        env.step({agent: np.zeros(2, np.float32) for agent in env.possible_agents})
        present.append(list(env.agents))
    assert present == [["robot_0", "robot_1", "robot_2"], *2 * [["robot_0", "robot_2"]], []]
    others = parallel_env(scenario("garage_sar", LEAVES), max_cycles=4)
    others.reset(seed=7)
    while others.agents:
        others.step({agent: np.zeros(2, np.float32) for agent in others.agents})
    assert env.record.state.true_pose.tobytes() == others.record.state.true_pose.tobytes()


def test_step_after_the_end_is_empty():
    # PettingZoo's guide to own environments; RLlib 2.60 steps once more when some are terminated and others truncated.
    env = parallel_env(scenario("garage_sar", LEAVES), max_cycles=2)
    env.reset(seed=7)
    while env.agents:
        *_, terminated, truncated, _ = env.step({agent: np.zeros(2, np.float32) for agent in env.agents})
    assert terminated == {"robot_0": False, "robot_1": True, "robot_2": False}
    assert truncated == {"robot_0": True, "robot_1": False, "robot_2": True}
    assert env.step({}) == ({}, {}, {}, {}, {})
    assert env.step({"robot_1": np.zeros(2, np.float32)}) == ({}, {}, {}, {}, {})


def test_environment_can_be_pickled_and_copied_before_its_mission_begins():
    env = parallel_env(scenario(), max_cycles=3)
    expected = driven_to(env, 5, wall_fearing)
    for copied in (pickle.loads(pickle.dumps(parallel_env(scenario(), max_cycles=3))), None):
        fresh = copied or copy.deepcopy(parallel_env(scenario(), max_cycles=3))
        assert driven_to(fresh, 5, wall_fearing) == expected
    env.reset(seed=1)
    with pytest.raises(LearningError, match=r"^a mission that is under way cannot be pickled or copied"):
        pickle.dumps(env)


def test_environment_has_the_spaces_that_pettingzoo_declares():
    env = parallel_env(scenario())
    assert env.observation_spaces == {agent: env.observation_space(agent) for agent in env.possible_agents}
    assert env.action_spaces == {agent: env.action_space(agent) for agent in env.possible_agents}
