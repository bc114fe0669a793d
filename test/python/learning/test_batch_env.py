"""Many missions at once, against single ones."""

from __future__ import annotations

import dataclasses
import os

import numpy as np
import pytest
from gymnasium.wrappers.vector import RecordEpisodeStatistics

from robotteamsim.errors import ScenarioError
from robotteamsim.learning import (
    Act,
    BatchEnv,
    DiscreteAct,
    LearningError,
    SearchReward,
    Steps,
    TeamEnv,
    VectorEnv,
    gym_env,
    parallel_env,
)
from robotteamsim.learning.missions import LONGEST_MESSAGE, LONGEST_NUMBER, Missions
from robotteamsim.learning.rules import Rules
from robotteamsim.learning.senses import Said
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import TrajectoryHash


def scenario(name="garage_sar", *overrides):
    return load(name, ["mission.time_limit_s=6", *overrides])


def actions_of(env, steps, seed=0):
    """Return random actions of a batch, float32, shape (steps, num_envs, robots, numbers)."""
    shape = steps, env.num_envs, env.num_robots, *env.act.space.shape
    return np.random.default_rng(seed).uniform(-1.0, 1.0, shape).astype(np.float32)


def missions(env, actions, seed):
    """Return the steps of each mission: observations, rewards, terminations and truncations; the first is `reset`."""
    steps = [(env.reset(seed), *np.zeros((3, env.num_envs, env.num_robots)))]
    steps += [env.step(acts)[:4] for acts in actions]
    return [[tuple(array[i] for array in step) for step in steps] for i in range(env.num_envs)]


@pytest.mark.slow
@pytest.mark.parametrize("said", [0, 2])
def test_each_mission_has_the_bits_of_a_single_one(said):
    made = scenario("garage_sar", "robots.formation=random", "schedule=[{at_s: 2.0, remove: 1}]")
    env = BatchEnv(made, 3, said=said, every=3)
    actions = actions_of(env, 25)
    for i, steps in enumerate(missions(env, actions, seed=5)):
        alone, found, expected = parallel_env(made, said=said, every=3), TrajectoryHash(), TrajectoryHash()
        vectors, _ = alone.reset(seed=5 + i)
        ends = {}, {}, {}
        for k, (observations, *found_ends) in enumerate(steps):
            for r, agent in enumerate(alone.possible_agents):
                np.testing.assert_array_equal(observations[r], vectors.get(agent, np.zeros_like(observations[r])))
                for found_end, end in zip(found_ends, ends, strict=True):
                    assert found_end[r] == found_end.dtype.type(end.get(agent, 0.0))
            if k == len(actions):
                break
            if alone.agents:
                acts = {agent: actions[k, i, int(agent[-1])] for agent in alone.agents}
                vectors, *ends, _ = alone.step(acts)
            else:  # the batch begins again in this step
                (vectors, _), ends = alone.reset(), ({}, {}, {})
        record, single = env.record(i), alone.record
        found.update(record.sim_time_ns, record.state.true_pose)
        expected.update(single.sim_time_ns, single.state.true_pose)
        assert found.hexdigest() == expected.hexdigest()


PLAIN = [
    ((), {}),
    (("robots.count=4", "robots.formation=random"), {"said": 2, "every": 1, "threads": 0}),
    (("control.localisation=odometry", "robots.odometry.alpha1=0.1"), {"max_cycles": 7}),
    # The team breaks apart, and its links are endangered before.
    (("network.lost_below_dbm=-60", "network.endangered_below_dbm=-55"), {"said": 1, "every": 2}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("overrides", "rules"), PLAIN)
def test_missions_that_are_stepped_together_have_the_records_of_single_ones(overrides, rules):
    made = scenario("garage_sar", *overrides)
    env, missions = BatchEnv(made, 2, **rules), Missions(made, Rules.of({k: rules[k] for k in rules if k != "threads"}))
    missions.watch = lambda *_: None  # so that its simulation makes its steps itself
    alone = TeamEnv(missions, None)
    actions, ended, contacts = np.abs(actions_of(env, 70)), 0, False
    env.reset(seed=11)
    alone.reset(seed=12)
    for acts in actions:
        step = env.step(acts)
        if not alone.agents:
            alone.reset()
            continue
        _, rewards, terminated, truncated, _ = alone.step(dict(zip(alone.agents, acts[1], strict=True)))
        assert list(step.rewards[1]) == [np.float32(reward) for reward in rewards.values()]
        assert list(step.terminated[1]) == list(terminated.values())
        assert list(step.truncated[1]) == list(truncated.values())
        ours, expected = env.record(1), alone.record
        for name in ("step_index", "sim_time_ns", "mission", "events", "victims", "task", "noise_db"):
            assert getattr(ours, name) == getattr(expected, name), name
        assert ours.decisions == expected.decisions
        assert list(map(list, ours.inboxes)) == list(map(list, expected.inboxes))
        assert ours.network.traffic == expected.network.traffic
        assert (ours.voice_map is None) == (expected.voice_map is None)
        for name in ("true_pose", "odometry_pose", "ranges_m", "contact", "local_best_m", "rssi_dbm", "hop_count"):
            np.testing.assert_array_equal(getattr(ours.state, name), getattr(expected.state, name))
        ended += bool(step.is_over[1])
        contacts |= bool(ours.state.contact.any())
    assert env.stepped_together.all()
    assert not missions.are_plain.any()
    assert ended
    assert contacts or overrides


def test_search_is_rewarded_while_all_robots_of_a_size_have_left():
    setup = resolve(scenario())
    larger = setup.robots[2].model_copy(update={"radius_m": 0.3})
    setup = dataclasses.replace(setup, robots=(*setup.robots[:2], larger))
    positions_m = np.array([[robot.start_pose[:2] for robot in setup.robots]])
    nothing, area = np.zeros(1, int), np.array([[1.0, *setup.scenario.mission.areas[0].center]])
    parts = np.array([[True, True, False]]), np.zeros((1, 3), bool), positions_m, nothing, nothing, area
    steps, reward = Steps(lambda _: None, np.array([0]), *parts), SearchReward(setup, [0, 1, 2])
    for _ in range(2):
        np.testing.assert_allclose(reward.of_step(steps), -0.002 * setup.scenario.run.step_s)


def test_missions_with_a_schedule_are_stepped_alone():
    env = BatchEnv(scenario("garage_sar", "schedule=[{at_s: 2.0, remove: 1}]"), 2)
    env.reset(1)
    assert not env.stepped_together.any()


def test_longest_message_is_shorter_than_the_limit_up_to_which_its_text_is_not_made():
    longest = -1.2345678901234567e-300
    numbers = 50
    text = Said((longest, longest), (longest,) * numbers).to_json()
    assert len(text) <= LONGEST_MESSAGE + LONGEST_NUMBER * numbers


@pytest.mark.slow
def test_scenarios_with_other_buildings_and_teams_are_stepped_together():
    env = BatchEnv([scenario(), scenario("isr_floor_0_sar", "robots.count=5")], 4)
    actions = actions_of(env, 8)
    assert env.num_robots == 5
    steps = missions(env, actions, seed=3)
    for i, name in enumerate(("garage_sar", "isr_floor_0_sar")):
        alone = parallel_env(scenario(*(name, "robots.count=5")[: i + 1]), teammates=4)
        vectors, _ = alone.reset(seed=3 + i)
        for k in range(8):
            for r in range(5):
                expected = vectors.get(f"robot_{r}", np.zeros(env.observe.space.shape))
                np.testing.assert_array_equal(steps[i][k][0][r], expected)
            vectors, *_ = alone.step({agent: actions[k, i, int(agent[-1])] for agent in alone.agents})


@pytest.mark.slow
def test_is_a_vector_env_with_one_agent_per_mission():
    env = VectorEnv(BatchEnv(scenario(), 2))
    alone = gym_env(scenario())
    assert env.single_observation_space == alone.observation_space
    assert env.single_action_space == alone.action_space
    env.action_space.seed(1)
    observations, _ = env.reset(seed=4)
    np.testing.assert_array_equal(observations[0], alone.reset(seed=4)[0])
    ends = 0
    for _ in range(40):
        actions = env.action_space.sample()
        observations, rewards, terminated, truncated, _ = env.step(actions)
        if ends:
            assert not any(array.any() for array in (rewards, terminated, truncated))
            break
        vector, reward, over, cut, _ = alone.step(actions[0])
        np.testing.assert_array_equal(observations[0], vector)
        assert (rewards[0], terminated[0], truncated[0]) == (pytest.approx(reward, rel=1e-6), over, cut)
        ends = truncated.all()
    assert ends


@pytest.mark.slow
@pytest.mark.parametrize("act", [None, DiscreteAct])
def test_is_a_vector_env_of_single_robots(act):
    env = VectorEnv(BatchEnv(scenario(), 2, **({"act": act} if act else {})), per_robot=True)
    observations, info = env.reset(seed=4)
    assert observations.shape == (6, *env.batch.observe.space.shape)
    assert info["present"].all()
    actions = env.action_space.sample()
    observations, rewards, terminated, _, _ = env.step(actions)
    alone = parallel_env(scenario(), **({"act": act} if act else {}))
    alone.reset(seed=4)
    vectors, *_ = alone.step({f"robot_{i}": actions[i] for i in range(3)})
    np.testing.assert_array_equal(observations[:3], np.array(list(vectors.values())))
    assert rewards.shape == terminated.shape == (6,)
    assert env.observation_space.contains(observations)


@pytest.fixture(scope="module")
def batch_of_three() -> BatchEnv:
    return BatchEnv("garage_sar", 3)


@pytest.mark.parametrize(
    ("do", "message"),
    [
        (lambda: BatchEnv("garage_sar", 0), "num_envs: 0; expected a whole number from 1 to 10000"),
        (lambda: BatchEnv("garage_sar", 10**6), "num_envs: 1000000; expected a whole number from 1 to 10000"),
        (
            lambda: BatchEnv("garage_sar", 2, threads=10**6),
            f"threads: 1000000; expected a whole number from 0 to {os.cpu_count()}, the cores of this machine",
        ),
        (lambda: BatchEnv(5, 2), "load: 5; expected a file, or the name of a shipped scenario"),
        (lambda: BatchEnv([], 2), "scenario: 0 scenarios for 2 missions; expected 1 to 2"),
        (lambda: BatchEnv(["garage_sar"] * 3, 2), "scenario: 3 scenarios for 2 missions; expected 1 to 2"),
        (
            lambda: BatchEnv("garage_sar", 2, evry=1),
            "evry: unknown; expected one of observe, act, reward, every, said, max_cycles, teammates",
        ),
        (
            lambda: BatchEnv([scenario(), scenario("garage_sar", "robots.laser.beams=91")], 2),
            "garage_sar: observe: Box(-1.0, 1.0, (114,), float32); expected that of garage_sar, "
            "Box(-1.0, 1.0, (204,), float32)",
        ),
        (
            lambda: BatchEnv("garage_sar", 2, teammates=10**9),
            "teammates: 1000000000; expected a whole number from 0 to 2999",
        ),
        (
            lambda: BatchEnv("garage_sar", 2, said=10**9, teammates=0),
            "said: 1000000000; expected a whole number from 0 to 1000000",
        ),
        (  # 181 beams, 13 numbers, and 100 teammates with 5 + 100,000
            lambda: BatchEnv("garage_sar", 2, said=10**5, teammates=100),
            "observation: 10000694 numbers; expected at most 10000000",
        ),
        (lambda: BatchEnv("garage_sar", 2).step(np.zeros((2, 3, 2))), "the mission has not begun; call reset first"),
        (lambda: BatchEnv("garage_sar", 2).reset(-1), "seed: -1; expected a whole number from 0 to 9007199254740991"),
    ],
)
def test_wrong_use_is_one_line(do, message):
    with pytest.raises((LearningError, ScenarioError)) as raised:
        do()
    assert str(raised.value) == message


@pytest.mark.parametrize(
    "which",
    [None, [True], [0, 1, 0], [0.0, 1.0, 0.0], [-1], [np.nan] * 3, "yes", ["0"] * 3, [[True] * 3], [], range(3)],
    ids=repr,
)
def test_missions_to_begin_are_bool_in_the_shape_of_the_batch(batch_of_three, which):
    batch = batch_of_three
    batch.reset(seed=1)
    with pytest.raises(LearningError, match=r"^which: .*, shape \(.*\); expected bool, shape \(3,\)$"):
        batch.begin(which)
    batch.begin([False] * 3)
    assert [batch.setup(i).scenario.run.seed for i in range(batch.num_envs)] == [1, 2, 3]
    batch.begin(np.array([False, True, False]))
    first, second, third = (batch.setup(i).scenario.run.seed for i in range(batch.num_envs))
    assert (first, third) == (1, 3)
    assert second != 2


def test_reward_of_a_vector_env_is_that_of_the_robots_that_acted():
    made = scenario("garage_sar", "schedule=[{at_s: 1.0, remove: 0}]")
    env, alone = VectorEnv(BatchEnv(made, 1)), gym_env(made)
    env.reset(seed=4)
    alone.reset(seed=4)
    still = np.zeros((1, 6), np.float32)
    for _ in range(4):
        _, rewards, *_ = env.step(still)
        assert rewards[0] == pytest.approx(alone.step(still[0])[1], rel=1e-6)


def test_arrays_of_a_step_may_be_kept():
    env = BatchEnv(scenario(), 2, max_cycles=2)
    begun = env.reset(1)
    steps = [env.step(np.full((2, 3, 2), 0.5)) for _ in range(2)]
    kept = [begun, *steps[0], *steps[1]]
    copies = [array.copy() for array in kept]
    env.begin(steps[1].is_over)
    env.step(np.zeros((2, 3, 2)))
    assert steps[1].is_over.all()
    assert not np.array_equal(steps[0].observations, steps[1].observations)
    for array, copied in zip(kept, copies, strict=True):
        np.testing.assert_array_equal(array, copied)


def test_actions_of_absent_robots_are_ignored():
    env = BatchEnv(scenario("garage_sar", "schedule=[{at_s: 0.0, remove: 0}]"), 1)
    env.reset(1)
    actions = np.zeros((1, 3, 2))
    env.step(actions)
    assert env.present.tolist() == [[False, True, True]]
    actions[0, 0] = np.nan
    assert (env.step(actions).observations[0, 0] == 0.0).all()


def test_mission_is_over_when_no_robot_is_left():
    removed = ", ".join(f"{{at_s: 1.0, remove: {i}}}" for i in range(5))
    changes = scenario("garage_rescue", "relays.count=0", f"schedule=[{removed}]")
    batch, alone = BatchEnv(changes, 1), parallel_env(changes)
    batch.reset(1)
    alone.reset(1)
    stand = np.zeros((1, *alone.action_space("robot_0").shape))
    while alone.agents:
        step = batch.step(np.repeat(stand[None], batch.num_robots, axis=1))
        alone.step(dict.fromkeys(alone.agents, stand[0]))
        assert step.is_over.tolist() == [not alone.agents]
    assert alone.record.sim_time_ns < 3 * 10**9


class Alone(Act):
    """Actions of one mission; those of stacked missions have one more axis."""

    def twists(self, actions):
        return np.zeros((len(actions), 3))


def test_actions_that_are_understood_for_one_mission_only_are_an_error():
    env = BatchEnv(scenario(), 2, act=Alone)
    env.reset(1)
    with pytest.raises(LearningError, match=r"^twists: array.*; expected finite numbers, shape \(2, 3, 3\)$"):
        env.step(np.zeros((2, 3, 2)))


def test_seed_of_numpy_does_not_overflow():
    env = BatchEnv(scenario(), 8)
    env.reset(np.uint8(250))
    assert [env.setup(i).scenario.run.seed for i in range(env.num_envs)] == list(range(250, 258))


def test_wrong_actions_name_mission_and_robot():
    env = BatchEnv(scenario(), 2)
    env.reset(1)
    actions = np.zeros((2, 3, 2))
    actions[1, 2, 0] = np.nan
    for wrong, message in (
        (actions, r"^mission 1: robot_2: action array\(\[nan,  0\.\]\): expected one of Box"),
        (actions[:1], r"^actions of shape \(1, 3, 2\); expected \(2, 3, 2\)$"),
        (actions.astype(str), r"^mission 0: robot_0: action array"),
        ([[[0.0, 0.0]], [[0.0]]], r"^actions of shape \(\); expected \(2, 3, 2\)$"),
    ):
        with pytest.raises(LearningError, match=message):
            env.step(wrong)


def test_robot_that_left_is_truncated_when_its_mission_is_over():
    # Gymnasium's RecordEpisodeStatistics counts what begins again in the next step as ended in this one.
    leaves = load("garage_sar", ["schedule=[{at_s: 1.0, remove: 1}]"])
    env = RecordEpisodeStatistics(VectorEnv(BatchEnv(leaves, 1, max_cycles=4), per_robot=True))
    env.reset(seed=7)
    ended = []
    for _ in range(9):
        _, _, terminated, truncated, _ = env.step(np.zeros((3, 2), np.float32))
        ended.append((terminated | truncated).astype(int).tolist())
    assert ended == [[0, 0, 0], [0, 1, 0], [0, 0, 0], [1, 1, 1], [0, 0, 0], [0, 0, 0], [0, 1, 0], [0, 0, 0], [1, 1, 1]]


CAR = "robots.drive={kind: car, wheelbase_m: 0.3, max_steering_rad: 0.6}"
"""It does not turn on the spot, which is the last action of `DiscreteAct`."""


@pytest.mark.parametrize(("per_robot", "shape"), [(True, (6, 5)), (False, (2, 3, 5))])
def test_vector_env_has_the_masks_of_cars_and_leaves_rows_without_a_robot_free(per_robot, shape):
    two_cars = scenario("garage_sar", CAR, "robots.count=2")
    env = VectorEnv(BatchEnv([scenario(), two_cars], 2, act=DiscreteAct), per_robot=per_robot)
    _, info = env.reset(seed=1)
    cars = np.zeros((2, 3), bool)
    cars[1, :2] = True
    expected = np.where(cars[..., None], (1, 1, 1, 1, 0), 1).reshape(shape)
    for _ in range(2):
        assert info["action_mask"].dtype == np.int8
        np.testing.assert_array_equal(info["action_mask"], expected)
        *_, info = env.step(np.zeros(env.action_space.shape, np.int64))


def test_masks_of_a_vector_env_are_those_of_gymnasium():
    env = VectorEnv(BatchEnv(scenario("garage_sar", CAR), 2, act=DiscreteAct), per_robot=True)
    _, info = env.reset(seed=1)
    env.single_action_space.seed(1)
    sampled = [env.single_action_space.sample(mask) for _ in range(20) for mask in info["action_mask"]]
    assert set(sampled) == {0, 1, 2, 3}


def test_continuous_actions_have_no_masks():
    env = VectorEnv(BatchEnv(scenario(), 2))
    assert set(env.reset(seed=1)[1]) == {"present"}
