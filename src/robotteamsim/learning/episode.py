"""One mission whose robots obey actions: what all environments are made of."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import msgspec
import numpy as np
from gymnasium.spaces import Box, Discrete

from robotteamsim.learning.act import Act, Commands
from robotteamsim.learning.arrays import array_of, numbers_of, shown
from robotteamsim.learning.driven import DrivenControllers
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.observe import LARGEST_PART, MOST_TEAMMATES, Memory, Observe, Percepts, in_bounds
from robotteamsim.learning.reward import Reward, SearchReward
from robotteamsim.learning.senses import Senses
from robotteamsim.mission.status import END_TEXTS, OUT_OF_DANGER
from robotteamsim.network.delivery import is_instant
from robotteamsim.rng import stream
from robotteamsim.scenario import Scenario, load
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.setup import check_headless, resolve
from robotteamsim.simulation import Simulation, StepRecord

LARGEST_SEED = 2**53

LONGEST_MESSAGE, LONGEST_NUMBER = 80, 26
"""Bytes of a message that says no numbers, and of each of its numbers, at most."""

AnyScenario = str | os.PathLike[str] | Scenario
"""A file, a shipped name, or a scenario."""


class Rules(msgspec.Struct, frozen=True, kw_only=True):
    """What agents perceive, decide and are rewarded for, and when; see `parallel_env`.

    teammates: how many teammates an observation has room for; None: as many as there are.
    """

    observe: type[Observe] = Observe
    act: type[Act] = Act
    reward: type[Reward] = SearchReward
    every: int = 5
    said: int = 0
    max_cycles: int | None = None
    teammates: int | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Rules:
        """Return the rules of an environment.

        Raises: LearningError: a key is unknown, or its value is of another kind or out of range.
        """
        for key in given:
            if key not in cls.__struct_fields__:
                raise LearningError(f"{key}: unknown; expected one of {', '.join(cls.__struct_fields__)}")
        for key, base in (("observe", Observe), ("act", Act), ("reward", Reward)):
            value = given.get(key, base)
            if not (isinstance(value, type) and issubclass(value, base)):
                raise LearningError(f"{key}: {value!r:.60}; expected a class derived from {base.__name__}")
        for key, least, most in (
            ("every", 1, None),
            ("said", 0, LARGEST_PART),
            ("max_cycles", 1, None),
            ("teammates", 0, MOST_TEAMMATES),
        ):
            value = given.get(key, least)
            if value is None and key in ("max_cycles", "teammates"):
                continue
            is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
            if not is_whole or value < least or (most is not None and value > most):
                limits = f"of at least {least}" if most is None else f"from {least} to {most}"
                raise LearningError(f"{key}: {value!r:.60}; expected a whole number {limits}")
        return cls(**given)


class Outcome(NamedTuple):
    """What a step of agents has led to; arrays have shape (n,).

    is_over: the mission has ended, its time or `max_cycles` is over, or no agent is left.
    """

    rewards: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    is_over: bool


class Episode:
    """A mission whose robots obey actions; the base, relays, firefighters and a command centre are no agents.

    A step is `every` steps of the simulation. Its reward is that of their records; that of the steps before the mission
    begins counts in the first one. The same seed and actions give the same bits.
    """

    def __init__(self, scenario: AnyScenario, rules: Rules) -> None:
        """Raises: RobotTeamSimError: one line: the scenario is invalid, or has no robot that can be driven."""
        scenario = scenario if isinstance(scenario, Scenario) else load(scenario)
        check_headless(scenario)
        self.scenario, self.rules = scenario, rules
        self.robot_ids = list(scenario.searcher_ids)
        """The agents."""
        if not self.robot_ids:
            raise LearningError(scenario.origin.line("robots.count: no robot can be driven", "robots.count"))
        arriving = [f"schedule.{i}.spawn" for i, event in enumerate(scenario.schedule) if event.spawn is not None]
        if arriving or not all(scenario.present_at_start):
            key = arriving[0] if arriving else "robots"
            text = f"{key}: a robot arrives later; expected robots that are present from the start"
            raise LearningError(scenario.origin.line(text, key))
        if lack := rules.reward.lack_of(scenario):
            raise LearningError(scenario.origin.line(lack, lack.partition(":")[0]))
        self.setup = resolve(scenario)
        self.observe = rules.observe(self.setup, self.robot_ids, rules.said, rules.teammates)
        self.act = rules.act(self.setup, self.robot_ids, rules.said)
        if not isinstance(self.act.space, Box | Discrete):
            raise LearningError(f"act: space {self.act.space!r:.60}; expected a Box or Discrete")
        self._num_victims = len(self.setup.scenario.mission.victims)
        self._rng = stream(scenario.run.seed, "episodes")
        self._simulation: Simulation | None = None
        self.percepts: Percepts
        """What the agents perceive, after `begin` and each `step`."""
        self.present: np.ndarray
        """Whether each agent is present then, bool, shape (n,)."""
        self.record: StepRecord | None = None
        """The last record of the simulation; None before the first step."""
        self.watch: Callable[[Simulation, StepRecord], None] | None = None
        """Is called when a mission begins and after each of its steps."""

    def __reduce__(self) -> tuple[type[Episode], tuple[Scenario, Rules]]:
        """Let an episode be pickled and copied. Raises: LearningError: its mission is under way."""
        if self._simulation is not None:
            raise LearningError(
                "a mission that is under way cannot be pickled or copied; do so before reset or after close"
            )
        return type(self), (self.scenario, self.rules)

    def begin(self, seed: Any = None) -> None:
        """Begin a mission; without a seed, with the next one of a sequence that begins with the last seed.

        The seed is `run.seed`, so it decides about random victims, voices and noise.

        Raises: RobotTeamSimError: one line: the seed is out of range, or the mission cannot begin.
        """
        if seed is not None and not (isinstance(seed, int | np.integer) and 0 <= seed <= LARGEST_SEED):
            raise LearningError(f"seed: {seed!r}; expected a whole number from 0 to {LARGEST_SEED}")
        if seed is not None:
            self._rng = stream(int(seed), "episodes")
        self._simulation = None
        run_seed = int(self._rng.integers(LARGEST_SEED) if seed is None else seed)
        run = self.scenario.run.model_copy(update={"seed": run_seed})
        self.setup = setup = resolve(self.scenario.model_copy(update={"run": run}))
        self.senses = Senses(setup, self.observe)
        self._controllers = DrivenControllers(setup)
        self._reward = self.rules.reward(setup, self.robot_ids)
        simulation = Simulation(setup, controllers=self._controllers)
        simulation.mission.start()
        self._sense(simulation)
        self._cycles, self.earned = 0, np.zeros(len(self.robot_ids))
        """How many steps the agents have made; and their rewards since the last one."""
        while not self.sensed.task.running:
            self.record = record = simulation.decide(self.sensed)
            if record.mission.state == "ended":
                raise LearningError(f"the mission ends before it begins: {END_TEXTS[record.mission.end]}")
            self.earned += self._rewards(record)
            self._sense(simulation)
        self._was_present = self.present
        self._simulation, self.percepts = simulation, self.senses.of_team(self.sensed)
        if self.watch is not None and self.record is not None:
            self.watch(simulation, self.record)

    def step(self, commands: Commands) -> Outcome:
        """Let the agents act. Raises: LearningError: no mission has begun."""
        simulation = self.check_begun()
        self._controllers.command(commands.decisions(self.robot_ids, self.percepts.poses[:, :2]))
        for _ in range(self.rules.every):
            record = simulation.decide(self.sensed)
            self.note(record)
            if self.watch is not None:
                self.watch(simulation, record)
            self._sense(simulation)
            if not self.is_running:
                break
        self.percepts = self.senses.of_team(self.sensed)
        return self.outcome()

    def note(self, record: StepRecord) -> None:
        """Note a step of the simulation that is complete."""
        self.record = record
        self.earned = self.earned + self._rewards(record)

    @property
    def is_running(self) -> bool:
        """Whether the mission had not ended after the last step."""
        return self.record is None or self.record.mission.state != "ended"

    def outcome(self) -> Outcome:
        """Return what the agents' last step has led to."""
        was_present, earned = self._was_present, self.earned
        self._was_present, self.earned = self.present, np.zeros(len(self.robot_ids))
        has_ended, is_cut = self.count_cycle()
        terminated = was_present & (has_ended | ~self.present)
        is_over = has_ended or is_cut or not self.present.any()
        return Outcome(earned * was_present, terminated, was_present & is_cut & ~terminated, is_over)

    def count_cycle(self) -> tuple[bool, bool]:
        """Note that the agents have made a step; return whether the mission has ended, and whether its time is over."""
        assert self.record is not None
        mission = self.record.mission
        self._cycles += 1
        is_late = mission.end == "time_limit"
        return mission.state == "ended" and not is_late, is_late or self._cycles == self.rules.max_cycles

    @property
    def is_plain(self) -> bool:
        """Whether nothing but robots that obey acts in the mission, and no message is lost: see `Together`."""
        scenario, simulation = self.setup.scenario, self.check_begun()
        network, mission, robots = scenario.network, scenario.mission, self.setup.robots
        others = scenario.fire is not None or scenario.schedule or scenario.base is not None or mission.exits
        walk = scenario.moves_people or any(victim.path for victim in mission.victims)
        doors = any(door.motion != "instant" for door in scenario.plan.doors)
        carried = any(robot.sensors or robot.laser.noise_m > 0.0 for robot in robots)
        return (
            self.watch is None
            and scenario.run.world == "box2d"
            and self.robot_ids == list(range(len(robots)))
            and not (others or walk or doors or carried or mission.saved_by == "firefighter")
            and is_instant(network, len(robots), scenario.run.step_ns)
            and network.max_message_bytes >= LONGEST_MESSAGE + LONGEST_NUMBER * self.rules.said
            and type(self.senses.memory) is Memory
            and isinstance(simulation.sensors, RobotSensors)
        )

    def end(self) -> None:
        """Forget the mission."""
        self._simulation = None

    def vectors(self) -> np.ndarray:
        """Return the observation of each agent, float32, shape (n, size of the space); 0 for an absent one."""
        return vectors_of(self.observe, self.percepts, self.present)

    def state(self) -> np.ndarray:
        """Return the state of the mission, for central critics, float32, within [-1, 1].

        Per member of the team: present, x and y in the building, cosine and sine of the yaw; per victim: saved, safe or
        dead, x and y, of those from the start; per area: explored; then the share of the time limit that is over. It is
        that of the last complete step of the simulation, one before the observations.
        """
        self.check_begun()
        record, plan = self.record, self.setup.plan
        assert record is not None
        poses = [reading.true_pose for reading in record.readings]
        places = in_bounds(plan, [(pose.x_m, pose.y_m) for pose in poses])
        yaws_rad = np.array([pose.yaw_rad for pose in poses])
        team = np.column_stack((np.ones(len(poses)), places, np.cos(yaws_rad), np.sin(yaws_rad)))
        team[~record.present] = 0.0
        status = record.mission
        done = np.array([victim in OUT_OF_DANGER for victim in status.victims[: self._num_victims]], float)
        victims_m = np.array([victim.position for victim in record.victims[: self._num_victims]]).reshape(-1, 2)
        victims = np.column_stack((done, in_bounds(plan, victims_m)))
        time = status.time_s / self.setup.scenario.mission.time_limit_s
        parts = (team.ravel(), victims.ravel(), np.array(status.explored, float), (time,))
        return np.clip(np.concatenate(parts), -1.0, 1.0).astype(np.float32)

    @property
    def state_size(self) -> int:
        """The size of `state`."""
        return 5 * len(self.setup.robots) + 3 * self._num_victims + len(self.setup.scenario.mission.areas) + 1

    def check_begun(self) -> Simulation:
        """Return the mission. Raises: LearningError: there is none."""
        if self._simulation is None:
            raise LearningError("the mission has not begun; call reset first")
        return self._simulation

    def _sense(self, simulation: Simulation) -> None:
        self.sensed = simulation.sense()
        self.present = self.sensed.present[self.robot_ids]
        self.senses.note_team(self.sensed)

    def _rewards(self, record: StepRecord) -> np.ndarray:
        return numbers_of("rewards", self._reward.of_step(record), self.present.shape)


def vectors_of(observe: Observe, percepts: Percepts, present: np.ndarray) -> np.ndarray:
    """Return the observations for percepts, also of stacked missions; 0 for absent agents.

    Raises: LearningError: the class of observations returns something else than it says.
    """
    vectors = array_of(observe.vectors(percepts))
    shape = (*present.shape, *observe.space.shape)
    if vectors.shape != shape or vectors.dtype != observe.space.dtype:
        found = f"observations {shown(vectors)}, shape {vectors.shape}"
        raise LearningError(f"{found}; expected {observe.space.dtype} within [-1, 1], shape {shape}")
    vectors[~present] = 0.0
    are_within = (vectors >= -1.0) & (vectors <= 1.0)  # NaN is not
    if not are_within.all():
        *_, row, number = place = tuple(np.argwhere(~are_within)[0])
        part = next(part for part in observe.parts if number < part.begin + part.size)
        found = f"robot_{observe.robot_ids[row]}: observation: part {part.name}[{number - part.begin}]"
        raise LearningError(f"{found}: {vectors[place]}; expected a number within [-1, 1]")
    return vectors
