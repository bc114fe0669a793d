"""Agents in buildings that nobody knows: what they perceive is what they and their teammates have seen, and no more."""

from __future__ import annotations

import math
import sys
from types import ModuleType

import msgspec
import numpy as np
import pytest

from robotteamsim.geometry import PoseReading
from robotteamsim.learning import BatchEnv, LearningError, PolicyController, Reward, gym_env, parallel_env, task
from robotteamsim.learning.found_floor import SIDE, squares_around
from robotteamsim.learning.tasks import FoundObserve
from robotteamsim.maps.found_map import FoundMap
from robotteamsim.mission import Sensed
from robotteamsim.scenario import from_mapping, load
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.plan import FREE, OCCUPIED
from robotteamsim.simulation import Simulation
from robotteamsim.testing import check_env
from study.learning.follow_frontier import follow

ROUND = {"beams": 181, "angle_min_rad": -3.14159265, "angle_max_rad": 3.14159265, "noise_m": 0.01}
GARBAGE = PoseReading(123.0, -45.0, 0.6, 0.8)


@pytest.fixture
def unknown(hall_scenario):
    """Make a scenario in the hall, which nobody knows; more walls, starts and sections are those given."""

    def make(walls=(), starts=((3.0, 4.0, 0.0), (3.0, 6.0, 0.0)), range_m=5.0, control=(), limit_s=60.0, **sections):
        data = hall_scenario().model_dump(mode="json", by_alias=True)
        data["plan"]["walls"] += [{"name": f"wall_{i}", "start": a, "end": b} for i, (a, b) in enumerate(walls)]
        data["robots"] = [
            {**data["robots"][0], "start_pose": start, "laser": {**ROUND, "range_max_m": range_m}} for start in starts
        ]
        data["mission"] = {"areas": [], "victims": [], "time_limit_s": limit_s}
        data["control"] = {"algorithm": "frontier", "map": "unknown", **dict(control)}
        return from_mapping(data | sections, "test")

    return make


def part_of(env, name):
    (part,) = [part for part in env.parts if part.name == name]
    return slice(part.begin, part.begin + part.size)


def driven(scenario, steps, choose, seed=3):
    """Return the observations of a mission, shape (steps + 1, agents, size), its rewards, and its environment."""
    env = parallel_env(**task("explore_unknown", scenario))
    vectors, _ = env.reset(seed=seed)
    seen, won = [list(vectors.values())], []
    while env.agents and len(won) < steps:
        vectors, rewards, *_ = env.step({agent: choose(vectors[agent]) for agent in env.agents})
        seen.append(list(vectors.values()))
        won.append(list(rewards.values()))
    return np.array(seen), np.array(won), env


def rest(_):
    return np.zeros(2, np.float32)


def ahead(vector):
    return np.array((0.5, 0.3), np.float32)


def test_observations_are_equal_while_nobody_looks_where_buildings_differ(unknown):
    closed = ((12.0, 0.2), (12.0, 9.8))
    hidden = ((15.0, 3.0), (15.0, 7.0))
    one, _, _ = driven(unknown([closed]), 40, follow)
    other, _, _ = driven(unknown([closed, hidden]), 40, follow)
    np.testing.assert_array_equal(one, other)
    seen, _, _ = driven(unknown([hidden]), 40, follow)
    assert not np.array_equal(one, seen)


def test_observations_do_not_depend_on_true_poses(unknown, monkeypatch):
    expected, _, _ = driven(unknown(), 30, ahead)
    make = Sensed.observation

    def without_truth(self, robot_id):
        observation = make(self, robot_id)
        return msgspec.structs.replace(
            observation, robot=msgspec.structs.replace(observation.robot, ground_truth=GARBAGE)
        )

    monkeypatch.setattr(Sensed, "observation", without_truth)
    found, _, _ = driven(unknown(), 30, ahead)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("building", ["hall", "garage_sar"])
def test_believed_poses_are_near_the_true_ones_but_not_they(building, unknown):
    """In a hall that nobody knows, and in a garage that agents know."""
    scenario = unknown() if building == "hall" else load(building, ["control.localisation=laser"])
    env = parallel_env(scenario, reward=Reward)
    env.reset(seed=1)
    for action in [(0.7, 0.1)] * 20 + [(0.0, 0.0)] * 3:  # the last record is one step old
        vectors, *_ = env.step(dict.fromkeys(env.agents, np.array(action, np.float32)))
    shares = (vectors["robot_0"][part_of(env, "pose")][:2] + 1.0) / 2.0
    error_m = math.dist(shares * scenario.plan.bounds.max, env.record.state.positions_m[0])
    assert 1e-3 < error_m < 0.2
    batch = BatchEnv(scenario, 2, reward=Reward)
    batch.reset(seed=1)
    assert not batch.stepped_together.any()


def test_radio_through_walls_that_nobody_knows_is_predicted_without_them(unknown):
    between = ((0.2, 5.0), (12.0, 5.0))
    steps = [driven(unknown(walls), 3, rest)[::2] for walls in ([], [between])]
    signals = [seen[-1, 0, part_of(env, "teammate_0")][3] for seen, env in steps]
    assert signals[0] == signals[1] > 0.0


def test_squares_are_what_the_map_has_around_the_robot():
    found = FoundMap(FloorPlan(name="field", bounds=Bounds(min=(-2.0, -2.0), max=(18.0, 18.0))))
    cells = found.cells.copy()
    cells[100:120, 100:120] = FREE  # x and y from 8 m to 10 m
    cells[110, 135] = OCCUPIED  # x 11.5 m to 11.6 m, y 9 m to 9.1 m
    found.show([((slice(None), slice(None)), cells)])
    middle = SIDE // 2
    facing_x = squares_around(found, np.array((8.5, 9.5, 0.0, 1.0)))
    expected = np.zeros((SIDE, SIDE))
    expected[middle - 1 : middle + 1, middle : middle + 2] = -1.0
    expected[middle, middle + 3] = 1.0
    np.testing.assert_allclose(facing_x, expected, atol=1e-9)
    half = math.sqrt(0.5)
    facing_y = squares_around(found, np.array((8.5, 9.5, half, half)))  # x is now to the right
    np.testing.assert_allclose(facing_y, np.rot90(expected), atol=1e-9)
    assert not squares_around(found, np.array((500.0, 9.5, 0.0, 1.0))).any()


def test_agents_know_what_teammates_have_sent_and_no_more(unknown):
    closed, starts = ((10.0, 0.2), (10.0, 9.8)), ((5.0, 5.0, 0.0), (15.0, 5.0, 0.0))
    shares = []
    for lost_below_dbm in (-95.0, -30.0):
        network = {"lost_below_dbm": lost_below_dbm, "endangered_below_dbm": lost_below_dbm + 5.0}
        scenario = unknown([closed], starts, 12.0, network=network)
        seen, _, env = driven(scenario, 12, rest)
        shares.append(seen[-1, :, part_of(env, "frontier").start])
    assert shares[1] == pytest.approx((0.42, 0.42), abs=0.03)  # of both halves
    assert shares[0] == pytest.approx([shares[1].sum()] * 2, abs=0.02)


def test_reward_is_the_share_of_the_floor_that_the_team_has_seen(unknown):
    _, won, env = driven(unknown(), 12, rest)
    x_m, y_m = np.meshgrid(np.arange(0.05, 20.0, 0.1), np.arange(0.05, 10.0, 0.1))
    # Centres of a robot of 0.2 m, with a margin of 0.05 m, between walls of 0.2 m.
    floor = (np.abs(x_m - 10.0) < 9.55) & (np.abs(y_m - 5.0) < 4.55)
    seen = (np.hypot(x_m - 3.0, y_m - 4.0) < 5.0) | (np.hypot(x_m - 3.0, y_m - 6.0) < 5.0)
    assert won.sum(0) == pytest.approx([10.0 * (seen & floor).sum() / floor.sum()] * 2, rel=0.05)
    assert not env.record.state.contact.any()


def test_who_drives_to_frontiers_explores_more_than_who_drives_at_random(unknown):
    walls = [((7.0, 0.2), (7.0, 6.0)), ((13.0, 4.0), (13.0, 9.8))]
    scenario = unknown(walls, ((3.0, 4.0, 0.0),), 4.0)
    rng = np.random.default_rng(1)
    _, won, _ = driven(scenario, 120, follow)
    _, by_chance, _ = driven(scenario, 120, lambda _: rng.uniform(-1.0, 1.0, 2).astype(np.float32))
    assert won.sum() > 9.5
    assert by_chance.sum() < 5.0


def test_environment_of_agents_who_map_passes_its_checks(unknown):
    made = task("explore_unknown", unknown(limit_s=8.0))
    check_env(**made, steps=20, said=1)
    alone, together = parallel_env(**made), gym_env(**made)
    vectors, _ = alone.reset(seed=1)
    vector, _ = together.reset(seed=1)
    np.testing.assert_array_equal(vector, np.concatenate(list(vectors.values())))


@pytest.mark.parametrize("localisation", ["laser", "odometry"])
def test_policy_perceives_as_in_training(localisation, monkeypatch, unknown):
    vectors = []

    class Policy(PolicyController):
        observe = FoundObserve

        def choose(self, vector):
            vectors.append(vector)
            return follow(vector)

    module = ModuleType("policy_of_unknown")
    module.Policy = Policy
    monkeypatch.setitem(sys.modules, "policy_of_unknown", module)
    heard = {"areas": [], "victims": [{"name": "ann", "position": [9.0, 4.0]}], "time_limit_s": 20.0}
    given = {"mission": heard, "run": {"seed": 1}}
    training = unknown(control={"localisation": localisation}, **given)
    trained, _, env = driven(training, 1000, follow, 1)
    assert trained[:, 0, part_of(env, "voice").start].any()
    Simulation(unknown(control={"algorithm": "policy_of_unknown:Policy", "localisation": localisation}, **given)).run()
    np.testing.assert_array_equal(np.array(vectors), trained[:-1].reshape(len(vectors), -1))


def test_team_goes_on_without_a_robot_that_leaves(unknown):
    env = parallel_env(**task("explore_unknown", unknown(limit_s=10.0, schedule=[{"at_s": 3.0, "remove": 1}])))
    vectors, _ = env.reset(seed=1)
    steps = 0
    while env.agents:
        vectors, *_ = env.step({agent: follow(vectors[agent]) for agent in env.agents})
        steps += 1
    assert (steps, list(vectors)) == (20, ["robot_0"])


def test_agents_know_where_they_start():
    with pytest.raises(LearningError, match=r"control\.mapping\.starts: 'unknown'; expected 'known'"):
        parallel_env(**task("explore_unknown", overrides=["control.mapping.starts=unknown"]))
