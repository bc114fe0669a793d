"""Tasks, against the tests of PettingZoo and Gymnasium, and their rewards against what happened, counted again."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import gymnasium
import networkx as nx
import numpy as np
import pytest
import shapely
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import max_cycles_test, parallel_api_test, parallel_seed_test, state_test

from robotteamsim import learning
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.learning import TASKS, BatchEnv, PolicyController, gym_env, parallel_env, task
from robotteamsim.scenario import from_mapping, load
from robotteamsim.scenario.plan import obstacles
from robotteamsim.simulation import Simulation

DATA = Path(__file__).parents[2] / "data"
LINE = {
    "vertices": [
        {"position": [3.0, 4.0], "neighbours": [1], "lengths_m": [6.0]},
        {"position": [9.0, 4.0], "neighbours": [0, 2], "lengths_m": [6.0, 6.0]},
        {"position": [15.0, 4.0], "neighbours": [1], "lengths_m": [6.0]},
    ]
}
EMPTY = {"areas": (), "victims": (), "time_limit_s": 60.0}


def short(name, limit_s=20, *overrides):
    return task(name, overrides=[f"mission.time_limit_s={limit_s}", *overrides])


def changed(scenario, **mission):
    """Return a scenario with other keys of its mission."""
    data = scenario.model_dump(mode="json", by_alias=True)
    return from_mapping(data | {"mission": data["mission"] | mission}, "test")


def wandering(env, most_turn):
    """Return a policy that drives ahead and turns at random."""
    rng = np.random.default_rng(0)

    def choose(agent):
        action = np.zeros(env.action_space(agent).shape, np.float32)
        action[0], action[-1] = 1.0, rng.uniform(-most_turn, most_turn)
        return action

    return choose


def recorded(settings, steps=400, seed=3, most_turn=0.6):
    """Return the records of a mission in which agents wander, and their rewards, shape (steps, agents).

    The reward of the first record, before the mission begins, is in the first step.
    """
    env = parallel_env(**settings, every=1)
    choose = wandering(env, most_turn)
    env.reset(seed=seed)
    records, rewards = [env.record], []
    while env.agents and len(records) <= steps:
        _, won, *_ = env.step({agent: choose(agent) for agent in env.agents})
        records.append(env.record)
        rewards.append([won.get(agent, 0.0) for agent in env.possible_agents])
    return records, np.array(rewards), env


def without_contacts(records, rewards, env):
    """Return the return of each agent without that for contacts."""
    ids = [int(agent.removeprefix("robot_")) for agent in env.possible_agents]
    touched_s = sum(0.1 * record.state.contact[ids] for record in records)
    return rewards.sum(0) + 0.1 * touched_s


def counted_again(plan, records, radius_m, walls=None):
    """Return which centres of 1 m cells were within a radius of a robot at full half seconds, and not behind walls."""
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    x_m, y_m = np.meshgrid(np.arange(x0 + 0.5, x1), np.arange(y0 + 0.5, y1))
    covered = np.zeros(x_m.shape, bool)
    for record in records:
        if record.step_index % 5 or record.mission.state != "running":
            continue
        for x, y in record.state.positions_m[record.present]:
            near = np.hypot(x_m - x, y_m - y) <= radius_m
            if walls is not None:
                lines = shapely.linestrings([[(x, y), end] for end in zip(x_m[near], y_m[near], strict=True)])
                near[near] = ~shapely.intersects(walls, lines)
            covered |= near
    return covered


@pytest.mark.slow
@pytest.mark.parametrize("name", TASKS)
def test_task_is_an_environment_of_pettingzoo_and_gymnasium(name):
    def make(**settings):
        return parallel_env(**short(name), **settings)

    def make_aec(**settings):
        return learning.env(**short(name), **settings)

    parallel_api_test(make(), num_cycles=60)
    parallel_seed_test(make, num_cycles=10)
    state_test(make_aec(), make())
    max_cycles_test(SimpleNamespace(parallel_env=make, env=make_aec))
    check_env(gym_env(**short(name)), skip_render_check=True)


@pytest.mark.parametrize("name", TASKS)
def test_task_is_registered_with_gymnasium(name):
    ids = [spec for spec in gymnasium.registry if spec.lower() == f"robotteamsim/{name.replace('_', '')}-v0"]
    env = gymnasium.make(*ids, every=2)
    vector, _ = env.reset(seed=1)
    assert env.observation_space.contains(vector)


@pytest.mark.parametrize("name", ["explore", "explore_unknown", "patrol"])
def test_missions_of_other_seeds_start_elsewhere(name):
    env = parallel_env(**short(name))
    starts = []
    for seed in (1, 2):
        env.reset(seed=seed)
        starts.append(env.record.state.positions_m.copy())
    assert (np.linalg.norm(starts[0] - starts[1], axis=1) > 0.1).all()


def test_coverage_is_rewarded_as_counted_again_in_a_hall(hall_scenario):
    scenario = changed(hall_scenario(), **EMPTY, coverage={"radius_m": 2.0})
    records, rewards, env = recorded(task("explore", scenario))
    covered = counted_again(scenario.plan, records, 2.0)
    assert 0.2 < covered.mean() < 0.9
    expected = np.full(2, 10.0 * covered.mean())
    assert without_contacts(records, rewards, env) == pytest.approx(expected, abs=1e-9)


@pytest.mark.slow
def test_coverage_in_the_garage_is_what_no_wall_hides():
    settings = short("explore", 120)
    records, rewards, env = recorded(settings, 1200)
    plan = settings["scenario"].plan
    solid, (width_m, height_m) = obstacles(plan), plan.bounds.max
    room = shapely.box(0.0, 0.0, width_m, height_m).difference(solid.buffer(0.3))  # for a robot of 20 cm
    room = max(getattr(room, "geoms", [room]), key=lambda part: part.area)
    x_m, y_m = np.meshgrid(np.arange(0.5, width_m), np.arange(0.5, height_m))
    floor = shapely.dwithin(room, shapely.points(x_m, y_m), 0.4)
    covered = counted_again(plan, records, 2.5, solid) & floor
    assert covered.sum() > 300
    share = without_contacts(records, rewards, env)[0] / 10.0
    assert share == pytest.approx(covered.sum() / floor.sum(), rel=0.05)


def test_split_network_is_a_loss_for_each_step_in_which_networkx_finds_it_split(hall_scenario):
    scenario = changed(hall_scenario(), **EMPTY, coverage={})
    scenario = from_mapping(
        scenario.model_dump(mode="json", by_alias=True)
        | {"radio": {"tx_power_dbm": -20.0}, "network": {"lost_below_dbm": -80.0, "endangered_below_dbm": -75.0}},
        "test",
    )
    records, rewards, env = recorded(task("connected_coverage", scenario), seed=5)
    _, alone, _ = recorded(task("explore", scenario), seed=5)
    split = 0
    for record in records:
        graph = nx.from_numpy_array(np.where(np.eye(2), 0.0, record.network.rssi_dbm >= -80.0))
        split += record.mission.state == "running" and not nx.is_connected(graph)
    assert 20 < split < 380
    assert (alone - rewards).sum(0) == pytest.approx([0.05 * 0.1 * split] * 2, abs=1e-9)
    assert env.possible_agents == ["robot_0", "robot_1"]


def test_idleness_is_the_loss_that_is_counted_by_hand(hall_scenario):
    scenario = changed(hall_scenario(), **EMPTY, patrol={"graph": LINE, "arrived_m": 2.0})
    records, rewards, env = recorded(task("patrol", scenario), most_turn=0.05)
    places, since_s, sum_s2, visits = [(3.0, 4.0), (9.0, 4.0), (15.0, 4.0)], [0.0] * 3, 0.0, set()
    for record in records:
        time_s = record.mission.time_s
        for vertex, place in enumerate(places):
            if any(math.dist(place, at) < 2.0 for at in record.state.positions_m.tolist()):
                since_s[vertex] = time_s
                visits.add(vertex)
        sum_s2 += 0.1 * sum(time_s - since for since in since_s) / 3.0
    assert visits == {0, 1, 2}
    assert without_contacts(records, rewards, env) == pytest.approx([-1e-4 * sum_s2] * 2, abs=1e-9)


@pytest.mark.slow
def test_rescue_is_rewarded_for_what_its_events_and_doses_say():
    near = ["mission.victims.0.position=[8.0, 5.0]", "mission.victims.1.position=[34.0, 4.0]"]
    near += ["fire.ignitions.0.position=[34.0, 3.0]", "mission.time_limit_s=150"]
    settings = task("rescue", "garage_rescue", near)
    records, rewards, env = recorded(settings, 1500)
    kinds = [event.kind for record in records for event in record.events]
    states = records[-1].mission.victims
    located = sum(state in ("located", "reported", "reached", "carried", "safe") for state in states)
    doses = sum(max(person.gas, person.heat) for person in records[-1].egress.people)
    assert kinds.count("victim_safe") >= 1
    assert doses > 0.1
    expected = 2.0 * kinds.count("victim_safe") - 2.0 * kinds.count("victim_dead") + 0.5 * located - doses
    failed = np.array([i in records[-1].failed for i in range(3)])
    found = without_contacts(records, rewards, env)
    assert found[~failed] == pytest.approx(expected, abs=1e-6)


def test_agents_know_the_floor_that_they_and_teammates_have_covered(hall_scenario):
    scenario = changed(hall_scenario(), **EMPTY, coverage={"radius_m": 2.0})
    env = parallel_env(**task("explore", scenario))
    (part,) = [part for part in env.parts if part.name == "floor"]
    vectors, _ = env.reset(seed=1)
    x_m, y_m = np.meshgrid(np.arange(20) + 0.5, np.arange(10) + 0.5)
    assert vectors["robot_0"][part.begin] == pytest.approx((np.hypot(x_m - 3.0, y_m - 4.0) <= 2.0).sum() / 200)
    vectors, *_ = env.step(dict.fromkeys(env.agents, np.zeros(2, np.float32)))
    both = (np.hypot(x_m - 3.0, y_m - 4.0) <= 2.0) | (np.hypot(x_m - 3.0, y_m - 6.0) <= 2.0)
    for name, y in (("robot_0", 4.0), ("robot_1", 6.0)):
        share, there_is, ahead, left = vectors[name][part.begin :][: part.size]
        assert share == pytest.approx(both.mean())
        assert there_is == 1.0
        goal = np.array((3.0, y)) + math.hypot(20.0, 10.0) * np.array((ahead, left))  # the yaw is 0
        column, row = np.floor(goal).astype(int)
        assert not both[row, column]


def test_agents_know_the_idleness_of_the_vertices_around_them(hall_scenario):
    scenario = changed(hall_scenario(), **EMPTY, patrol={"graph": LINE})
    env = parallel_env(**task("patrol", scenario), every=10)
    (part,) = [part for part in env.parts if part.name == "vertices"]
    assert part.size == 4 * 3  # a vertex and two neighbours
    vectors, _ = env.reset(seed=1)
    rest = np.zeros(2, np.float32)
    for _ in range(3):
        vectors, *_ = env.step(dict.fromkeys(env.agents, rest))
    diagonal_m = math.hypot(20.0, 10.0)
    # Robot 0 is at the first vertex, and has said so to robot 1, 2 m to the left.
    for name, left_m, idle_s in (("robot_0", 0.0, 0.0), ("robot_1", -2.0, 0.5)):
        own, neighbour, none = vectors[name][part.begin :][: part.size].reshape(3, 4)
        assert own[:3] == pytest.approx((1.0, 0.0, left_m / diagonal_m), abs=1e-6)
        assert 0.0 <= own[3] <= (idle_s + 0.6) / 300.0
        assert neighbour == pytest.approx((1.0, 6.0 / diagonal_m, left_m / diagonal_m, 3.0 / 300.0), abs=1e-6)
        assert none.tolist() == [0.0] * 4


def test_agents_remember_the_last_image_of_their_thermal_cameras():
    env = parallel_env(**short("rescue", 200, "fire.ignitions.0.position=[13.0, 3.0]", "robots.start=[6, 5, 0]"))
    (part,) = [part for part in env.parts if part.name == "heat"]
    env.reset(seed=1)
    ahead = np.array((0.5, 0.0), np.float32)
    heat = np.zeros(5)
    while heat[1] == 0.0:  # a reading comes once in a second, an action twice
        vectors, *_ = env.step(dict.fromkeys(env.agents, ahead if env.record.sim_time_s < 7.0 else 0.0 * ahead))
        heat = vectors["robot_0"][part.begin :]
        assert heat[0] > 0.05 or env.record.sim_time_s < 2.0
    reading, _ = env.record.readings[0], env.step(dict.fromkeys(env.agents, 0.0 * ahead))
    x, y = reading.ground_truth.x_m, reading.ground_truth.y_m
    assert reading.ground_truth.qz == pytest.approx(0.0, abs=0.01)
    assert math.dist((x + 10.0 * heat[2], y + 10.0 * heat[3]), (13.5, 3.5)) < 3.0
    assert heat[4] > 60.0 / 300.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["explore", "patrol", "rescue"])
def test_policy_perceives_as_in_training(name, monkeypatch):
    vectors = []

    def action(vector):
        left, right = vector[100:181].min(), vector[:80].min()
        return np.clip(np.array((vector[60:121].min(), left - right), np.float32), -1.0, 1.0)

    class Policy(PolicyController):
        observe = TASKS[name].observe

        def choose(self, vector):
            vectors.append(vector)
            return action(vector)

    module = ModuleType("policy_of_task")
    module.Policy = Policy
    monkeypatch.setitem(sys.modules, "policy_of_task", module)
    settings, trained = short(name, 30, "run.seed=11"), []
    env = parallel_env(**settings)
    current, _ = env.reset(seed=11)
    while env.agents:
        trained += current.values()
        current, *_ = env.step({agent: action(vector) for agent, vector in current.items() if agent in env.agents})
    overrides = ["control={algorithm: 'policy_of_task:Policy'}"]
    Simulation(short(name, 30, "run.seed=11", *overrides)["scenario"]).run()
    np.testing.assert_array_equal(np.array(vectors), np.array(trained))


@pytest.mark.parametrize("name", ["explore", "patrol"])
def test_missions_of_a_batch_remember_for_themselves(name):
    made = short(name, 5)
    batch, alone = BatchEnv(**made, num_envs=2), parallel_env(**made)
    observations = batch.reset(seed=4).copy()
    ahead = np.tile(np.array((1.0, 0.1), np.float32), (2, 3, 1))
    for i in range(2):
        vectors, _ = alone.reset(seed=4 + i)
        np.testing.assert_array_equal(observations[i], np.array(list(vectors.values())))
    for _ in range(10):
        step = batch.step(ahead)
        vectors, rewards, *_ = alone.step(dict.fromkeys(alone.agents, ahead[0, 0]))
    np.testing.assert_array_equal(step.observations[1], np.array(list(vectors.values())))
    np.testing.assert_array_equal(step.rewards[1], np.array(list(rewards.values()), np.float32))


@pytest.mark.slow
def test_graphs_of_patrolling_sim_are_patrolled():
    graph = f"mission.patrol.graph={DATA / 'patrol' / 'cumberland.graph'}"
    env = parallel_env(**task("patrol", DATA / "scenarios" / "cumberland.yaml", [graph]), max_cycles=5)
    vectors, _ = env.reset(seed=1)
    degrees = [len(vertex.neighbours) for vertex in load("garage_sar", [graph]).mission.patrol.graph.vertices]
    assert env.parts[-1].size == 4 * (1 + max(degrees))
    assert all(vector[env.parts[-1].begin] == 1.0 for vector in vectors.values())


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: task("serch"), "there is no task 'serch'; expected one of garage_search, floor_search, explore, "),
        (
            lambda: parallel_env(**task("garage_search", "garage_sar", ["mission.areas=[]", "mission.victims=[]"])),
            "--set: mission.areas: none, and there are no victims; expected some of them",
        ),
        (
            lambda: parallel_env(**task("garage_search", "garage_sar", ["mission.area_order=nearest"])),
            "--set: mission.area_order: nearest; expected given, because agents choose no areas",
        ),
        (
            lambda: parallel_env(**task("explore", load("garage_sar", ["mission.areas=[]"]))),
            "garage_sar.yaml: mission.coverage: none; expected a section, such as {radius_m: 2.5}",
        ),
        (
            lambda: parallel_env(**task("explore_unknown", "garage_sar")),
            "garage_sar.yaml: control.map: known; expected unknown, so that there is something to find",
        ),
        (
            lambda: parallel_env(**task("explore_unknown", load("garage_unknown"))),
            "garage_unknown.yaml: mission.areas: 5, the last of which ends a mission; expected none",
        ),
        (
            lambda: BatchEnv(**task("explore", load("garage_sar", ["mission.coverage={}"])), num_envs=2),
            "garage_sar.yaml: mission.areas: 5, the last of which ends a mission; expected none",
        ),
        (
            lambda: parallel_env(**task("connected_coverage", "tutorial_arena")),
            "tutorial_arena.yaml: robots.count: 1; expected at least 2, which can be connected",
        ),
        (
            lambda: gym_env(**task("patrol", load("garage_sar"))),
            "garage_sar.yaml: mission.areas: 5, the last of which ends a mission; expected none",
        ),
        (
            lambda: gym_env(**task("patrol", "tutorial_arena", ["mission.patrol.spacing_m=100"])),
            "--set: mission.patrol.spacing_m: 100 m leaves no two places of the plan linked",
        ),
        (lambda: gym_env(**task("rescue", "garage_sar")), "garage_sar.yaml: fire: none; expected one"),
        (
            lambda: gym_env(**task("rescue", "garage_fire", ["mission.victims=[]"])),
            "--set: mission.victims: none; expected somebody to rescue",
        ),
        (lambda: task("explore", "no_such"), "no_such: "),
        (
            lambda: task("explore", load("garage_sar"), ["run.seed=2"]),
            "overrides: ['run.seed=2']; expected none with a scenario that is loaded",
        ),
    ],
)
def test_mistake_is_one_line(make, message):
    with pytest.raises(RobotTeamSimError) as raised:
        make()
    assert str(raised.value).startswith(message)
    assert "\n" not in str(raised.value)
