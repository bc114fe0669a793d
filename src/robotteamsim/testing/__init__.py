"""Checks of a user's own controllers, sensors, worlds and environments, for tests: see `docs/testing.md`."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from io import StringIO
from itertools import islice
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.interface import EVERYBODY, Decision, Message
from robotteamsim.mission import Sensed
from robotteamsim.recording.bag_types import ROS1, ROS2, message_type
from robotteamsim.rng import stream
from robotteamsim.scenario import Scenario, load
from robotteamsim.scenario.controllers import control_kind
from robotteamsim.scenario.problems import suggestion
from robotteamsim.scenario.sections import Team
from robotteamsim.scenario.sensors.base import messages_of, naming, reading_of, text_of
from robotteamsim.scenario.worlds import WORLDS
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Simulation
from robotteamsim.simulation.controllers import TeamControllers

if TYPE_CHECKING:
    from rosbags.typesys import Stores

    from robotteamsim.learning import TeamEnv
    from robotteamsim.scenario.sensors import Sensor

STRANGE = ("?", "", "null", "[]", "{}", '{"level_db": "loud"}', "\u00e9")
"""Messages of other programs, which may use the same network."""

_Team = tuple[Decision, ...]


def check_controller(
    controller: type | str,
    scenario: str | os.PathLike[str] = "garage_sar",
    overrides: Sequence[str] = (),
    steps: int = 100,
) -> None:
    """Check that a controller drives the robots of missions as `Controller` says.

    It returns what a `Decision` may be; the same with the same seed, also beside another team; stands still while no
    mission runs; and goes on with messages of other programs, and when a robot leaves and comes back.

    Args:   controller: a class of a module, or a name as of `control.algorithm`.
            scenario, overrides: as of `load`; the robots must be present from the start.
            steps: of each mission, at least 1.
    Raises: AssertionError: one line that says what it does instead, and in which step.
            RobotTeamSimError: it cannot be made, or the scenario is invalid.
    """
    name = controller if isinstance(controller, str) else f"{controller.__module__}:{controller.__qualname__}"
    if "<locals>" in name or steps < 1:
        what = f"{name}: expected a class of a module" if "<locals>" in name else f"steps: {steps}; expected at least 1"
        raise ScenarioError(f"check_controller: {what}")
    unknown = [] if "known" in control_kind(name).maps else ["control.map=unknown"]
    loaded = load(scenario, [f"control.algorithm={name}", *unknown, *overrides])
    setup, other = resolve(loaded), resolve(_with_seed(loaded, loaded.run.seed + 1))
    team = list(islice(_decisions(name, _mission(setup)), steps))
    _check_same(name, team, islice(_decisions(name, _mission(setup)), steps), "in a second mission with the same seed")
    beside = zip(_decisions(name, _mission(setup)), _decisions(name, _mission(other)), strict=False)
    _check_same(name, team, (one for one, _ in islice(beside, steps)), "beside another team")
    _check_pause(name, setup)
    for _ in islice(_decisions(name, _mission(setup, with_strangers=True)), steps):
        pass
    mission = _mission(setup)
    left = _decisions(name, mission)
    next(left)
    mission.remove_robot(0)
    next(left)
    mission.spawn_robot(0)
    for _ in islice(left, steps):
        pass


class _WithStrangers(TeamControllers):
    """The controllers of a scenario, whose robots also hear other programs."""

    def step(self, sensed: Sensed) -> _Team:
        text, robots = STRANGE[sensed.step_index % len(STRANGE)], max(len(sensed.inboxes), 2)
        sensed.inboxes = [
            (*inbox, Message((i + 1) % robots, EVERYBODY, text)) for i, inbox in enumerate(sensed.inboxes)
        ]
        return super().step(sensed)


def _mission(setup: Setup, *, with_strangers: bool = False) -> Simulation:
    """Return a mission that runs."""
    simulation = Simulation(setup, controllers=_WithStrangers(setup) if with_strangers else None)
    simulation.mission.start()
    return simulation


def _with_seed(scenario: Scenario, seed: int) -> Scenario:
    return scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": seed})})


def _decisions(name: str, simulation: Simulation) -> Iterator[_Team]:
    """Return what the team decides, step by step. Raises: AssertionError: a controller was stopped."""
    while True:
        record = simulation.step()
        for robot_id, decision in enumerate(record.decisions):
            assert not decision.fault, f"{name}: robot {robot_id}, step {record.step_index}: {decision.fault}"
        yield tuple(record.decisions)


def _check_pause(name: str, setup: Setup) -> None:
    """Raises: AssertionError: a robot moves while its mission is paused."""
    mission = _mission(setup)
    decisions = _decisions(name, mission)
    for _ in islice(decisions, 12):
        pass
    mission.mission.pause()
    next(decisions)  # controllers know the task as of the step before
    for team in islice(decisions, 5):
        for robot_id, decision in enumerate(team):
            stands = not any(msgspec.structs.astuple(decision.twist))
            assert stands, f"{name}: robot {robot_id} moves while the mission is paused"


def _check_same(name: str, expected: Sequence[_Team], found: Iterator[_Team], where: str) -> None:
    """Raises: AssertionError: a decision differs."""
    for step, (before, now) in enumerate(zip(expected, found, strict=True), start=1):
        for robot_id, (one, other) in enumerate(zip(before, now, strict=True)):
            for field in one.__struct_fields__:
                values = getattr(one, field), getattr(other, field)
                is_same = field in ("belief", "found") or values[0] == values[1]  # those two are pictures
                assert is_same, (
                    f"{name}: robot {robot_id}, step {step}: {field} {values[1]!r:.60} {where}, {values[0]!r:.60} "
                    "before; expected the same: random numbers from stream(), nothing shared by robots"
                )


def check_sensor(
    sensor: Mapping[str, Any],
    scenario: str | os.PathLike[str] = "garage_sar",
    overrides: Sequence[str] = (),
    steps: int = 50,
) -> None:
    """Check that a sensor measures as `Sensor` says, and that its readings arrive in ROS 1, in ROS 2 and in bags.

    It measures at least once; the same with the same seed; leaves the mission as it is without it; and its messages are
    those of their types, from which `reading` makes the reading again.

    Args:   sensor: a member of `robots.sensors`, such as {"kind": "sonar", "name": "front"}.
            scenario, overrides: as of `load`.
            steps: of each mission, at least 1.
    Raises: AssertionError: one line that says what it does instead, and in which step.
            RobotTeamSimError: the scenario is invalid, such as of an unknown kind.
    """
    plain = load(scenario, overrides)
    key = "robots.sensors" if isinstance(plain.robots, Team) else "robots.0.sensors"
    setup = resolve(load(scenario, [*overrides, f"{key}={json.dumps([sensor])}"]))
    carried = setup.robots[0].sensors[0]
    name, mission, again, without = carried.name, Simulation(setup), Simulation(setup), Simulation(plain)
    measured = 0
    for _ in range(steps):
        record, other = mission.step(), again.step()
        what, time_ns = f"{name}, step {record.step_index}", record.sim_time_ns
        moved = record.state.true_pose.tobytes() != without.step().state.true_pose.tobytes()
        assert not moved, f"{what}: the robots are elsewhere than without it; expected a sensor that changes nothing"
        for robot_id in np.flatnonzero(record.present).tolist():
            readings = [one.readings[robot_id].sensors.get(name) for one in (record, other)]
            found = [_messages(carried, time_ns, reading) for reading in readings]
            assert found[0] == found[1], f"{what}: another reading with the same seed; expected noise of the generator"
            if found[0]:
                measured += 1
                _check_reading(carried, what, readings[0], found[0])
    assert measured, f"{name}: measured nothing in {steps} steps"


def _messages(sensor: Sensor, time_ns: int, reading: Any) -> dict[tuple[str, Stores], bytes]:
    """Return the messages of a reading, by topic and version of ROS; {} if it did not measure."""
    if reading is None:
        return {}
    text_of(sensor, 0, reading)
    messages = messages_of(sensor, time_ns, 0, reading)
    with naming(sensor, 0):
        return {
            (topic, ros): message_type(sensor.topics[topic], ros).encode(message)
            for topic, message in messages.items()
            for ros in (ROS1, ROS2)
        }


def _check_reading(sensor: Sensor, what: str, measured: Any, messages: dict[tuple[str, Stores], bytes]) -> None:
    """Raises: AssertionError: the reading of a message is another one than was measured."""
    topic, type_name = next(iter(sensor.topics.items()))
    for ros in (ROS1, ROS2):
        reading = reading_of(sensor, 0, message_type(type_name, ros).decode(messages[topic, ros]))
        assert _is_same(measured, reading), (
            f"{what}: reading(message) is another reading than that of the message, to the last bit and in its type: "
            f"{reading!r:.60} instead of {measured!r:.60}"
        )


def _is_same(one: Any, other: Any) -> bool:
    """Return whether two readings have equal bits; NaN is equal to NaN."""
    if isinstance(one, np.ndarray):
        is_array = isinstance(other, np.ndarray) and one.dtype == other.dtype
        return is_array and np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if isinstance(one, float):
        return isinstance(other, float) and (one == other or (one != one and other != other))
    if isinstance(one, (tuple, list)):
        return type(one) is type(other) and len(one) == len(other) and all(map(_is_same, one, other))
    return type(one) is type(other) and bool(one == other)


def check_env(scenario: str | Scenario, steps: int = 60, **rules: Any) -> None:
    """Check that observations, actions and rewards make an environment, alone and as one of many missions.

    It passes PettingZoo's test of a `ParallelEnv`; has the same numbers for the same seed and actions, also in its
    second mission, which has nothing of the first; and a `BatchEnv` has those of single missions.

    Args:   scenario, rules: as of `parallel_env`, such as a task: `check_env(**task("explore"))`.  steps: of agents.
    Raises: AssertionError: one line that says what differs, and in which step. RobotTeamSimError: see `parallel_env`.
    """
    # Late, because only environments need it.
    from pettingzoo.test import parallel_api_test

    from robotteamsim.learning import BatchEnv, parallel_env

    env, again = (parallel_env(scenario, **rules) for _ in range(2))
    with redirect_stdout(StringIO()):
        parallel_api_test(env, num_cycles=steps)
    alone = _episode(env, 7, steps)
    _check_equal(alone, _episode(again, 7, steps), "with the same seed in a second environment")
    _check_equal(alone, _episode(env, 7, steps), "with the same seed in a second mission")
    batch = BatchEnv(scenario, 2, **rules)
    observations = batch.reset(6)
    generator, agents = stream(7, "check_env"), env.possible_agents
    found = [{agent: (observations[1, row], 0.0) for row, agent in enumerate(agents)}]
    while len(found) < len(alone):
        actions = np.stack([[batch.act.rest] * len(agents), _actions(env, generator)])
        step = batch.step(actions)
        found.append({agent: (step.observations[1, k], step.rewards[1, k]) for k, agent in enumerate(agents)})
    _check_equal(alone, found, "as the second mission of a batch")


_Numbers = list[dict[str, tuple[np.ndarray, float]]]


def _actions(env: TeamEnv, generator: np.random.Generator) -> list[np.ndarray]:
    """Return an action of each agent."""
    spaces = [copy.deepcopy(env.action_space(agent)) for agent in env.possible_agents]
    for space in spaces:
        space.seed(int(generator.integers(2**31)))
    return [np.asarray(space.sample()) for space in spaces]


def _episode(env: TeamEnv, seed: int, steps: int) -> _Numbers:
    """Return observation and reward of each agent, at the beginning and after each step, until the mission is over."""
    generator, (vectors, _) = stream(seed, "check_env"), env.reset(seed)
    found = [{agent: (vector.copy(), 0.0) for agent, vector in vectors.items()}]
    for _ in range(steps):
        if not env.agents:
            break
        actions = dict(zip(env.possible_agents, _actions(env, generator), strict=True))
        vectors, rewards, *_ = env.step({agent: actions[agent] for agent in env.agents})
        found.append({agent: (vector.copy(), rewards[agent]) for agent, vector in vectors.items()})
    return found


def _check_equal(expected: _Numbers, found: _Numbers, where: str) -> None:
    """Raises: AssertionError: a number differs."""
    assert len(expected) == len(found), f"{len(found) - 1} steps {where}, {len(expected) - 1} before"
    for step, (before, now) in enumerate(zip(expected, found, strict=True)):
        for agent, (vector, reward) in before.items():
            number = np.flatnonzero(vector != now[agent][0])
            assert not number.size, (
                f"{agent}, step {step}: number {number[0]} of the observation is {now[agent][0][number[0]]} {where}, "
                f"{vector[number[0]]} before"
            )
            same = np.float32(reward) == np.float32(now[agent][1])
            assert same, f"{agent}, step {step}: reward {now[agent][1]:g} {where}, {reward:g} before; see Reward.begin"


def check_world(world: str) -> None:
    """Check that a world keeps the contract of `AnyWorld`: motion, contacts, doors, objects, team and sensors.

    It runs the tests of `testing.contract` with pytest, in this process, for some seconds.

    Args:   world: a name as of `run.world`.
    Raises: AssertionError: a line for each fact that does not hold.
            ScenarioError: there is no such world.
    """
    # Late, because only this check needs pytest.
    from robotteamsim.testing.worlds import failures_of

    if world not in WORLDS:
        known = f"known: {', '.join(WORLDS)}{suggestion(world, [*WORLDS])}"
        raise ScenarioError(f"check_world: no world '{world}'; {known}")
    failures = [f"{world}: {failure}" for failure in failures_of(world)]
    assert not failures, "\n".join(failures)
