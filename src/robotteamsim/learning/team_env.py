"""A mission as a PettingZoo `ParallelEnv`."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Space
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils import parallel_to_aec

from robotteamsim.learning.act import Act
from robotteamsim.learning.driven import DrivenControllers, driven_ids
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.observe import Observe, Part, in_bounds
from robotteamsim.learning.reward import Reward, SearchReward
from robotteamsim.mission.status import END_TEXTS, OUT_OF_DANGER
from robotteamsim.rng import stream
from robotteamsim.scenario import Scenario, load
from robotteamsim.setup import Setup, check_headless, resolve
from robotteamsim.simulation import Simulation, StepRecord

Agent = str
Vectors = dict[Agent, np.ndarray]
Infos = dict[Agent, dict[str, Any]]

LARGEST_SEED = 2**53


def parallel_env(
    scenario: str | os.PathLike[str] | Scenario,
    *,
    observe: type[Observe] = Observe,
    act: type[Act] = Act,
    reward: type[Reward] = SearchReward,
    every: int = 5,
    said: int = 0,
    max_cycles: int | None = None,
    render_mode: str | None = None,
) -> TeamEnv:
    """Return a mission as an environment of many agents, `robot_0` and so on.

    Args:   scenario: a file, a shipped name, or a scenario; its own controllers are not used.
            observe, act, reward: what agents perceive, decide and are rewarded for; derive from them to change it.
            every: an agent decides in each so many steps of the simulation (`run.step_s`, 0.1 s), and holds its command
                in between.
            said: how many numbers each message to the other robots has.
            max_cycles: all agents are truncated after so many of their steps; None: only at the mission's time limit.
            render_mode: None, or rgb_array.
    Raises: RobotTeamSimError: one line: the scenario is invalid, or has no robot that can be driven.
    """
    for key, given, base in (("observe", observe, Observe), ("act", act, Act), ("reward", reward, Reward)):
        if not (isinstance(given, type) and issubclass(given, base)):
            raise LearningError(f"{key}: {given!r:.60}; expected a class derived from {base.__name__}")
    loaded = scenario if isinstance(scenario, Scenario) else load(scenario)
    classes = observe, act, reward
    return TeamEnv(loaded, classes, every=every, said=said, max_cycles=max_cycles, render_mode=render_mode)


def env(scenario: str | os.PathLike[str] | Scenario, **settings: Any) -> AECEnv[Agent, np.ndarray, Any]:
    """Return the environment of `parallel_env` in PettingZoo's other form, in which agents act one after the other."""
    return parallel_to_aec(parallel_env(scenario, **settings))


class TeamEnv(ParallelEnv[Agent, np.ndarray, Any]):  # type: ignore[misc]  # PettingZoo has no types
    """A mission whose robots obey actions; the base, relays, firefighters and a command centre are no agents.

    A step is `every` steps of the simulation. Its reward is that of their records; that of the steps before the mission
    begins counts in the first one. An agent is terminated when the mission has ended or it is no longer present, and
    truncated at the time limit. The same seed and actions give the same bits.
    """

    def __init__(
        self,
        scenario: Scenario,
        classes: tuple[type[Observe], type[Act], type[Reward]],
        *,
        every: int,
        said: int,
        max_cycles: int | None,
        render_mode: str | None,
    ) -> None:
        """See `parallel_env`."""
        for key, value, least in (("every", every, 1), ("said", said, 0), ("max_cycles", max_cycles, 1)):
            if value is not None and (not isinstance(value, int | np.integer) or value < least):
                raise LearningError(f"{key}: {value!r}; expected a whole number of at least {least}")
        if render_mode not in (None, "rgb_array"):
            raise LearningError(f"render_mode: {render_mode!r}; expected None or 'rgb_array'")
        check_headless(scenario)
        self.metadata = {"name": f"{scenario.name}_v0", "render_modes": ["rgb_array"], "is_parallelizable": True}
        self.metadata["render_fps"] = max(round(1.0 / (every * scenario.run.step_s)), 1)
        self.render_mode = render_mode
        self._scenario, self._every, self._max_cycles = scenario, every, max_cycles
        self._rng = stream(scenario.run.seed, "episodes")
        robot_ids = driven_ids(scenario)
        if not robot_ids:
            raise LearningError(scenario.origin.line("robots.count: no robot can be driven", "robots.count"))
        arriving = [f"schedule.{i}.spawn" for i, event in enumerate(scenario.schedule) if event.spawn is not None]
        if arriving or not all(scenario.present_at_start):
            key = arriving[0] if arriving else "robots"
            text = f"{key}: a robot arrives later; expected robots that are present from the start"
            raise LearningError(scenario.origin.line(text, key))
        self._ids = {f"robot_{i}": i for i in robot_ids}
        self.possible_agents = list(self._ids)
        self.agents: list[Agent] = []
        self._classes, self._said = classes, said
        self._take(resolve(scenario))
        self._num_victims = len(self._setup.scenario.mission.victims)
        self._observation_spaces = {i: self._observe[i].space for i in robot_ids}
        self._action_spaces = {i: self._act[i].space for i in robot_ids}
        self._simulation: Simulation | None = None
        self.record: StepRecord | None = None
        """The last record of the simulation, for own measures; None before the first step."""

    def observation_space(self, agent: Agent) -> Space[Any]:
        """Return the space of an agent's observations; `Observe.parts` describes it."""
        return self._observation_spaces[self._id(agent)]

    def action_space(self, agent: Agent) -> Space[Any]:
        """Return the space of an agent's actions."""
        return self._action_spaces[self._id(agent)]

    def parts(self, agent: Agent) -> tuple[Part, ...]:
        """Return the parts of an agent's observations."""
        return self._observe[self._id(agent)].parts

    @property
    def state_space(self) -> Box:
        """The space of `state`."""
        mission, robots = self._setup.scenario.mission, len(self._setup.robots)
        size = 5 * robots + 3 * self._num_victims + len(mission.areas) + 1
        return Box(-1.0, 1.0, (size,), np.float32)

    def state(self) -> np.ndarray:
        """Return the state of the mission, for central critics, float32, within [-1, 1].

        Per member of the team: present, x and y in the building, cosine and sine of the yaw; per victim: saved, safe or
        dead, x and y, of those from the start; per area: explored; then the share of the time limit that is over. It is
        that of the last complete step of the simulation, one before the observations.
        """
        _, record = self._running()
        plan = self._setup.plan
        poses = [reading.true_pose for reading in record.readings]
        places = in_bounds(plan, [(pose.x_m, pose.y_m) for pose in poses])
        yaws_rad = np.array([pose.yaw_rad for pose in poses])
        team = np.column_stack((np.ones(len(poses)), places, np.cos(yaws_rad), np.sin(yaws_rad)))
        team[~record.present] = 0.0
        status = record.mission
        done = np.array([victim in OUT_OF_DANGER for victim in status.victims[: self._num_victims]], float)
        victims_m = np.array([victim.position for victim in record.victims[: self._num_victims]]).reshape(-1, 2)
        victims = np.column_stack((done, in_bounds(plan, victims_m)))
        time = status.time_s / self._setup.scenario.mission.time_limit_s
        parts = (team.ravel(), victims.ravel(), np.array(status.explored, float), (time,))
        return np.clip(np.concatenate(parts), -1.0, 1.0).astype(np.float32)

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Vectors, Infos]:
        """Begin a mission; without a seed, with the next one of a sequence that begins with the last seed.

        The seed is `run.seed`, so it decides about random victims, voices and noise.
        """
        if seed is not None and not (isinstance(seed, int | np.integer) and 0 <= seed <= LARGEST_SEED):
            raise LearningError(f"seed: {seed!r}; expected a whole number from 0 to {LARGEST_SEED}")
        if seed is not None:
            self._rng = stream(seed, "episodes")
        self.agents = []
        run_seed = int(self._rng.integers(LARGEST_SEED) if seed is None else seed)
        run = self._scenario.run.model_copy(update={"seed": run_seed})
        self._take(resolve(self._scenario.model_copy(update={"run": run})))
        self._controllers = DrivenControllers(self._setup)
        self._simulation = simulation = Simulation(self._setup, controllers=self._controllers)
        self._cycles = 0
        simulation.mission.start()
        self._sense(simulation)
        self._early = dict.fromkeys(self._ids.values(), 0.0)
        while not self._sensed.inputs.task.running:
            self.record = simulation.decide(self._sensed)
            if self.record.mission.state == "ended":
                raise LearningError(f"the mission ends before it begins: {END_TEXTS[self.record.mission.end]}")
            self._add_rewards(self._early)
            self._sense(simulation)
        present = self._sensed.inputs.present
        self.agents = [agent for agent, i in self._ids.items() if present[i]]
        return self._vectors(), self._infos()

    def step(
        self, actions: Mapping[Agent, Any]
    ) -> tuple[Vectors, dict[Agent, float], dict[Agent, bool], dict[Agent, bool], Infos]:
        """Let all agents act, and return observations, rewards, terminations, truncations and infos of each.

        Raises: RobotTeamSimError: one line: the mission has not begun or has ended, an agent without an action, or an
                action that is not of its space.
        """
        simulation, record = self._running()
        if not self.agents:
            raise LearningError("the mission has ended; call reset")
        if not isinstance(actions, Mapping):
            raise LearningError(f"actions: {actions!r:.60}; expected an action by the name of each agent")
        if set(actions) != set(self.agents):
            given, expected = (", ".join(sorted(map(str, agents))) or "nobody" for agents in (actions, self.agents))
            raise LearningError(f"actions of {given}; expected {expected}")
        for agent, action in actions.items():
            i = self._ids[agent]
            pose = self._observe[i].pose(self._perceived[i])
            self._controllers.give(i, self._act[i].decision(action, pose))
        acting = {agent: self._ids[agent] for agent in self.agents}
        won = {i: self._early[i] for i in acting.values()}
        self._early = dict.fromkeys(self._early, 0.0)
        for _ in range(self._every):
            self.record = record = simulation.decide(self._sensed)
            self._add_rewards(won)
            self._sense(simulation)
            if record.mission.state == "ended":
                break
        self._cycles += 1
        has_ended = record.mission.state == "ended" and record.mission.end != "time_limit"
        is_cut = record.mission.end == "time_limit" or self._cycles == self._max_cycles
        present = self._sensed.inputs.present
        terminated = {agent: bool(has_ended or not present[i]) for agent, i in acting.items()}
        truncated = {agent: is_cut and not terminated[agent] for agent in acting}
        vectors, infos = self._vectors(), self._infos()
        self.agents = [] if has_ended or is_cut else [agent for agent, i in self._ids.items() if present[i]]
        rewards = {agent: won[i] for agent, i in acting.items()}
        return vectors, rewards, terminated, truncated, infos

    def render(self) -> np.ndarray | None:
        """Return the mission as a picture, uint8, shape (rows, columns, 3); None without a render mode."""
        if self.render_mode is None:
            return None
        from robotteamsim.learning.picture import picture  # late, because only pictures need Matplotlib

        _, record = self._running()
        return picture(self._setup, record)

    def close(self) -> None:
        """End the mission."""
        self._simulation, self.agents = None, []

    def _take(self, setup: Setup) -> None:
        """Use a resolved scenario from now on."""
        observe, act, reward = self._classes
        self._setup = setup
        self._observe = {i: observe(setup, i, self._said) for i in self._ids.values()}
        self._act = {i: act(setup, i, self._said) for i in self._ids.values()}
        self._reward = reward(setup)

    def _running(self) -> tuple[Simulation, StepRecord]:
        if self._simulation is None or self.record is None:
            raise LearningError("the mission has not begun; call reset first")
        return self._simulation, self.record

    def _sense(self, simulation: Simulation) -> None:
        self._sensed = simulation.sense()
        inputs = self._sensed.inputs
        self._perceived = inputs.observations()
        for i, observe in self._observe.items():
            if inputs.present[i]:
                observe.note(self._perceived[i], inputs.inboxes[i])

    def _add_rewards(self, to: dict[int, float]) -> None:
        """Add the rewards of the last record, by robot id."""
        assert self.record is not None
        rewards = self._reward.of_step(self.record, list(to))
        for i in to:
            if not math.isfinite(rewards[i]):
                raise LearningError(f"robot_{i}: reward {rewards[i]!r}; expected a finite number")
            to[i] += rewards[i]

    def _vectors(self) -> Vectors:
        return {agent: self._vector(self._ids[agent]) for agent in self.agents}

    def _vector(self, robot_id: int) -> np.ndarray:
        inputs, observe = self._sensed.inputs, self._observe[robot_id]
        if not inputs.present[robot_id]:
            return np.zeros(observe.space.shape, np.float32)
        vector = observe.vector(self._perceived[robot_id], inputs.task)
        if np.shape(vector) != observe.space.shape or not np.isfinite(vector).all():
            raise LearningError(f"robot_{robot_id}: observation {vector!r:.60}; expected one of {observe.space}")
        return vector

    def _id(self, agent: Agent) -> int:
        """Return the robot of an agent. Raises: LearningError: there is no such agent."""
        if agent not in self._ids:
            raise LearningError(f"there is no agent {agent!r}; expected one of {', '.join(self._ids)}")
        return self._ids[agent]

    def _infos(self) -> Infos:
        return {agent: self._act[self._ids[agent]].info() for agent in self.agents}
