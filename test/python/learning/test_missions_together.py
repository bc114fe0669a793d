"""Rewards, records, memories and errors of missions that are stepped together."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.learning import BatchEnv, LearningError, Memory, Observe, SearchReward, parallel_env
from robotteamsim.scenario import load


def scenario(name="garage_sar", *overrides):
    return load(name, ["mission.time_limit_s=6", *overrides])


class LinkReward(SearchReward):
    """Looks at L of eq. (16)."""

    def of_step(self, steps):
        links = [record.network.link.sum() for record in steps.records]
        return super().of_step(steps) + np.array(links)[:, None]


def test_links_by_distance_beside_links_by_signal_are_those_of_each_alone():
    made = scenario(), scenario("garage_sar", "network.link=distance", "network.max_distance_m=1.2")
    env = BatchEnv(made, 2, reward=LinkReward)
    env.reset(0)
    rewards = env.step(np.zeros((2, 3, 2))).rewards
    for i, one in enumerate(made):
        alone = parallel_env(one, reward=LinkReward)
        alone.reset(seed=i)
        _, expected, *_ = alone.step({agent: np.zeros(2, np.float32) for agent in alone.agents})
        assert list(rewards[i]) == [np.float32(reward) for reward in expected.values()]


def test_memory_of_states_is_used_again_also_by_who_keeps_records():
    env, places, kept = BatchEnv(scenario("garage_sar", "mission.victims=[]"), 4), set(), []
    env.reset(0)
    for step in range(24):
        if step % 2:
            env.begin(np.arange(4) == step // 2 % 4)
        env.step(np.zeros((4, 3, 2)))
        kept.append(env.record(step % 4))
        places.add(env._groups[0]._last.state.true_pose.ctypes.data)
    assert len(places) <= 3


class FailsLater(SearchReward):
    def of_step(self, steps):
        if any(record.step_index == 9 for record in steps.records):
            raise RuntimeError("no reward")
        return super().of_step(steps)


def test_batch_that_an_error_has_stopped_in_the_middle_needs_a_reset():
    env = BatchEnv(scenario(), 2, reward=FailsLater)
    env.reset(1)
    rest = np.zeros((2, 3, 2))
    env.step(rest)
    with pytest.raises(RuntimeError, match="no reward"):
        env.step(rest)
    with pytest.raises(LearningError, match="call reset first"):
        env.step(rest)
    env.reset(1)
    env.step(rest)


def test_observation_that_keeps_what_it_was_given_has_it_later():
    given = []

    class Keeping(Observe):
        def vectors(self, percepts):
            given.append((percepts.poses, percepts.poses.copy()))
            return super().vectors(percepts)

    env = BatchEnv(scenario(), 2, observe=Keeping)
    env.reset(1)
    for _ in range(3):
        env.step(np.ones((2, 3, 2), np.float32))
    assert all(np.array_equal(kept, copied) for kept, copied in given)
    assert not np.array_equal(given[0][1], given[-1][1])


def test_records_of_a_step_that_is_over_are_refused_and_its_numbers_may_be_kept_or_changed():
    kept = []

    class Late(SearchReward):
        def of_step(self, steps):
            kept.append((steps, [part.copy() for part in steps[1:]]))
            rewards = super().of_step(steps)
            kept[-1][0].missions[:] = 0
            return rewards

    env = BatchEnv(scenario(), 2, reward=Late)
    env.reset(1)
    env.step(np.ones((2, 3, 2), np.float32))
    for steps, copies in kept:
        assert all(np.array_equal(part, copy) for part, copy in zip(steps[2:], copies[1:], strict=True))
        with pytest.raises(LearningError, match=r"^records: of a step that is over; expected to be"):
            steps.records  # noqa: B018 - a property


def test_memory_may_decide_itself_whether_it_looks():
    looked = []

    class Sometimes(Memory):
        def __init__(self, setup, robot_ids):
            super().__init__(setup, robot_ids)
            self.looks = True

        def look(self, readings):
            looked.append(len(readings))

    class Looking(Observe):
        remembers = Sometimes

    env = BatchEnv(scenario(), 2, observe=Looking)
    env.reset(1)
    env.step(np.zeros((2, 3, 2)))
    assert looked == [3] * len(looked)
    assert len(looked) >= 2 * 5


def test_mission_that_is_not_there_has_no_record():
    env = BatchEnv([scenario(), scenario("isr_floor_0_sar")], 3)
    env.reset(1)
    assert env.record(0) is None or env.record(0).step_index >= 1
    for wrong in (-1, 3):
        with pytest.raises(LearningError, match=f"^there is no mission {wrong}; expected 0 to 2$"):
            env.record(wrong)


def test_batch_of_which_a_mission_could_not_begin_needs_a_reset(monkeypatch):
    env = BatchEnv(scenario(), 2)
    env.reset(1)
    monkeypatch.setattr(SearchReward, "begin", lambda self, mission, setup: 1 / (mission != 0))
    with pytest.raises(ZeroDivisionError):
        env.reset(1)
    monkeypatch.undo()
    for do in (lambda: env.step(np.zeros((2, 3, 2))), lambda: env.begin(np.array([True, True]))):
        with pytest.raises(LearningError, match="call reset first"):
            do()
