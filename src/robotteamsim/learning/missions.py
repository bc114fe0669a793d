"""Missions whose robots obey actions: what all environments are made of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box, Discrete

from robotteamsim import _core
from robotteamsim._core.state import LINKS_CHANGED, PLACE_REACHED, VOICE_CHANGED
from robotteamsim.geometry import Twist
from robotteamsim.interface import Decision
from robotteamsim.learning.act import Commands
from robotteamsim.learning.arrays import numbers_of
from robotteamsim.learning.driven import Believed, DrivenControllers, believes, known_setup
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.observe import area_of, cos_sin
from robotteamsim.learning.reward import Steps
from robotteamsim.learning.rules import AnyScenario, Rules
from robotteamsim.learning.senses import Rows, Senses
from robotteamsim.mission.status import END_TEXTS, OUT_OF_DANGER
from robotteamsim.network.delivery import is_instant
from robotteamsim.rng import stream
from robotteamsim.scenario import Scenario, load
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.setup import Setup, check_headless, resolve
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.world.world import World

LARGEST_SEED = 2**53

LONGEST_MESSAGE, LONGEST_NUMBER = 80, 26
"""Bytes of a message that says no numbers, and of each of its numbers, at most."""

_JUDGED = PLACE_REACHED | LINKS_CHANGED | VOICE_CHANGED
"""What makes a mission look at a step."""


class Outcome(NamedTuple):
    """What a step of the agents of k missions has led to; arrays have shape (k, n), the last one (k,).

    is_over: the mission has ended, its time or `max_cycles` is over, or no agent is left.
    """

    rewards: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    is_over: np.ndarray


class _Sent(NamedTuple):
    """The messages of all agents that arrive in a step: what they say, and from where, in `map` [m]."""

    commands: Commands
    positions_m: np.ndarray

    def decisions(self, mission: int, robot_ids: Sequence[int]) -> list[Decision]:
        """Return the decisions of the agents of a mission."""
        return self.commands.of(mission).decisions(robot_ids, self.positions_m[mission])


class _Made(NamedTuple):
    """A step that missions have made together: what was measured, and the messages that arrived."""

    state: _core.state.State
    arriving: _Sent | None


class _RecordsOfStep:
    """Returns the records of the missions while a reward judges a step."""

    def __init__(self, record_of: Callable[[int], StepRecord]) -> None:
        self._record_of, self.is_over = record_of, False

    def __call__(self, mission: int) -> StepRecord:
        if self.is_over:
            raise LearningError("records: of a step that is over; expected to be asked for in of_step")
        return self._record_of(mission)


class _Mission:
    """The objects of a mission.

    sensed: the step to be judged next; None if the batch has made it.
    believed: what the agents perceive of it; None: what was sensed.
    record: the last complete step that somebody has looked at.
    """

    def __init__(self, scenario: Scenario, seed: int) -> None:
        run = scenario.run.model_copy(update={"seed": seed})
        self.setup = resolve(scenario.model_copy(update={"run": run}))
        self.controllers = DrivenControllers(self.setup)
        self.simulation = Simulation(self.setup, controllers=self.controllers)
        self.sensed: StepRecord | None = None
        self.believed: Believed | None = None
        self.record: StepRecord | None = None

    @property
    def sensors(self) -> RobotSensors:
        """Those of the robots."""
        sensors = self.simulation.sensors
        assert isinstance(sensors, RobotSensors)
        return sensors


class Missions:
    """Missions of one scenario whose robots obey actions; base, relays, firefighters, command centre are no agents.

    A step is `every` steps of the simulation. Its reward is that of their records; that of the steps before the mission
    begins counts in the first one. The same seed and actions give the same bits, alone or beside others.

    Missions in which nothing acts but robots that obey are *plain*, and are stepped together:

    - World, lasers, odometry, voices and links of all are one call, `Batch.move` and `Batch.sense`.
    - A step that was sensed is judged when the agents have decided again: first the mission, but only if something has
      happened in it, then the reward.
    - From then on, until the next one is judged, its record can be made from the state, if somebody asks for it.
      World and mission of a `Simulation` hear of several quiet steps at once: they lag behind by `_passed` steps.
    """

    def __init__(self, scenario: AnyScenario, rules: Rules, number: int = 1, threads: int = 1) -> None:
        """Args: threads: that step missions in one call, 0: one per core.

        Raises: RobotTeamSimError: one line: the scenario is invalid, or has no robot that can be driven.
        """
        self.scenario, self.rules, self.number, self._threads = _checked(scenario, rules), rules, number, threads
        self.robot_ids = list(self.scenario.searcher_ids)
        """The agents."""
        self._setup = resolve(self.scenario)
        known = known_setup(self._setup, {})
        self.observe = rules.observe(known, self.robot_ids, rules.said, rules.teammates)
        self.act = rules.act(known, self.robot_ids, rules.said)
        if not isinstance(self.act.space, Box | Discrete):
            raise LearningError(f"act: space {self.act.space!r:.60}; expected a Box or Discrete")
        self.watch: Callable[[Simulation, StepRecord], None] | None = None
        """Is called when a mission begins and after each of its steps."""
        shape = number, len(self.robot_ids)
        self.are_plain = np.zeros(number, bool)
        """Whether nothing but robots that obey acts in a mission, as of its beginning, and no message is lost."""
        self._rngs = [stream(self.scenario.run.seed, "episodes") for _ in range(number)]
        self._missions: list[_Mission | None] = [None] * number
        self._senses = Senses(known, self.observe, number)
        self._reward = rules.reward(self._setup, self.robot_ids, number)
        self._was_present, self._earned, self._cycles = np.zeros(shape, bool), np.zeros(shape), np.zeros(number, int)
        """Who was present in the agents' last step; their rewards since then; and how many steps they have made."""
        self.present = np.zeros(shape, bool)
        """Whether each agent is present."""
        self._contact, self._positions_m = np.zeros(shape, bool), np.zeros((*shape, 2))
        """Of the last step of the simulation, as in `Steps`."""
        self._explored, self._saved, self._areas = np.zeros(number, int), np.zeros(number, int), np.zeros((number, 3))
        """Of the last step that was judged, as in `Steps`."""
        self._times_ns, self._quiet_until_ns = np.zeros((2, number), np.int64)
        """Its stamp; and before which stamp the mission judges no step in which nothing has happened."""
        self._has_ended, self._is_late = np.zeros((2, number), bool)
        # Of plain missions:
        self._core = _core.simulation.Batch(number, len(self.robot_ids), self.observe.beams, threads)
        self._must_judge = np.zeros(number, bool)
        self._passed, self._noise_left = np.zeros((2, number), int)
        """How many judged steps the simulation of a mission has not heard of, and for how many there is noise."""
        self._last: _Made | None = None
        self._judged: _Made | None = None
        """The last step, and the one before it, which was judged."""
        self._decided: tuple[_Sent, bool] | None = None
        """What the agents did in the one that was judged, and whether they sent their messages."""

    def __reduce__(self) -> tuple[type[Missions], tuple[Any, ...]]:
        """Let missions be pickled and copied. Raises: LearningError: one is under way."""
        if any(mission is not None for mission in self._missions):
            raise LearningError(
                "a mission that is under way cannot be pickled or copied; do so before reset or after close"
            )
        return type(self), (self.scenario, self.rules, self.number, self._threads)

    def begin(self, which: int, seed: Any = None) -> None:
        """Begin a mission; without a seed, with the next one of a sequence that begins with the last seed.

        The seed is `run.seed`, so it decides about random victims, voices and noise.

        Raises: RobotTeamSimError: one line: the seed is out of range, or the mission cannot begin.
        """
        if seed is not None and not (isinstance(seed, int | np.integer) and 0 <= seed <= LARGEST_SEED):
            raise LearningError(f"seed: {seed!r}; expected a whole number from 0 to {LARGEST_SEED}")
        if seed is not None:
            self._rngs[which] = stream(int(seed), "episodes")
        self._missions[which] = None
        mission = _Mission(self.scenario, int(self._rngs[which].integers(LARGEST_SEED) if seed is None else seed))
        mission.simulation.mission.start()
        found = mission.controllers.found
        self._senses.begin(which, known_setup(mission.setup, found))
        self._reward.begin(which, replace(mission.setup, found=found))
        self._cycles[which] = self._passed[which] = 0
        self._earned[which] = 0.0
        while not (sensed := self._sense(which, mission)).task.running:
            record = self._decide(which, mission)
            if self._has_ended[which]:
                raise LearningError(f"the mission ends before it begins: {END_TEXTS[record.mission.end]}")
        self._was_present[which] = self.present[which]
        self._senses.perceive_team(which, sensed, mission.believed)
        self._missions[which] = mission
        self.are_plain[which] = self._is_plain(which, mission)
        if self.are_plain[which]:
            self._must_judge[which] = True
            self._put(which, mission)
        if self.watch is not None and mission.record is not None:
            self.watch(mission.simulation, mission.record)

    def step(self, which: np.ndarray, commands: Commands) -> Outcome:
        """Let the agents of some missions act.

        Args:   which: their numbers, ascending; a mission that is left out begins again before its next step.
                commands: of all missions, those of others are ignored.
        Raises: LearningError: one of them has not begun. After any other error, all must begin again.
        """
        for i in which.tolist():
            self.check_begun(i)
        are_plain = self.are_plain[which]
        try:
            if are_plain.any():
                self._step_together(which[are_plain], commands)
            for i in which[~are_plain].tolist():
                self._step_alone(i, commands.of(i))
        except BaseException:  # some missions have made a part of a step
            self.end()
            raise
        rows = self._rows(which)
        self._cycles[rows] += 1
        was_present, present, is_late = self._was_present[rows].copy(), self.present[rows], self._is_late[rows]
        has_ended = self._has_ended[rows] & ~is_late
        is_cut = is_late | (self._cycles[rows] == self.rules.max_cycles)
        terminated = was_present & (has_ended[:, None] | ~present)
        truncated = was_present & is_cut[:, None] & ~terminated
        rewards = self._earned[rows] * was_present
        self._was_present[rows], self._earned[rows] = present, 0.0
        return Outcome(rewards, terminated, truncated, has_ended | is_cut | ~present.any(1))

    def record(self, which: int) -> StepRecord | None:
        """Return the last complete step of a mission; None before the first one, and if there is no mission."""
        mission = self._missions[which]
        return None if mission is None or mission.record is None else self._last_record(which)

    def vectors(self) -> np.ndarray:
        """Return the observations of all agents, see `Senses.vectors`."""
        return self._senses.vectors(self.present)

    def setup(self, which: int) -> Setup:
        """Return the setup of a mission, with its seed. Raises: LearningError: it has not begun."""
        return self.check_begun(which).setup

    def check_begun(self, which: int) -> _Mission:
        """Return a mission. Raises: LearningError: it has not begun."""
        mission = self._missions[which]
        if mission is None:
            raise LearningError("the mission has not begun; call reset first")
        return mission

    def check_all_begun(self) -> None:
        """Raises: LearningError: a mission has not begun, or all were ended by an error."""
        for which in range(self.number) if None in self._missions else ():
            self.check_begun(which)

    def end(self) -> None:
        """Forget all missions."""
        self._missions = [None] * self.number

    def _last_record(self, which: int) -> StepRecord:
        """Return the last complete step of a mission that has made one."""
        mission = self.check_begun(which)
        if self._passed[which]:
            mission.record = mission.simulation.pass_quietly(self._follow(which), self._decisions(which))
        assert mission.record is not None
        return mission.record

    def _step_alone(self, which: int, commands: Commands) -> None:
        mission = self.check_begun(which)
        mission.controllers.command(commands.decisions(self.robot_ids, self._senses.percepts.poses[which, :, :2]))
        for _ in range(self.rules.every):
            record = self._decide(which, mission)
            if self.watch is not None:
                self.watch(mission.simulation, record)
            sensed = self._sense(which, mission)
            if self._has_ended[which]:
                break
        self._senses.perceive_team(which, sensed, mission.believed)

    def _sense(self, which: int, mission: _Mission) -> StepRecord:
        """Let a simulation make a step, up to what is perceived in it."""
        mission.sensed = sensed = mission.simulation.sense()
        present, ids = sensed.present[self.robot_ids], self.robot_ids
        self.present[which], self._contact[which] = present, sensed.state.contact[ids]
        self._positions_m[which] = np.where(present[:, None], sensed.state.positions_m[ids], 0.0)
        self._times_ns[which] = sensed.sim_time_ns
        mission.believed = mission.controllers.perceive(sensed)
        self._senses.note_team(which, sensed, mission.believed)
        return sensed

    def _decide(self, which: int, mission: _Mission) -> StepRecord:
        """Complete the step of a simulation, and reward it."""
        assert mission.sensed is not None
        mission.record = record = mission.simulation.decide(mission.sensed)
        self._note_judged(which, mission.simulation)
        self._add_rewards(np.array([which]), lambda _: record)
        return record

    def _note_judged(self, which: int, simulation: Simulation) -> None:
        mission = simulation.mission
        status = mission.status
        self._explored[which], self._saved[which] = status.areas_explored, status.victims_saved
        self._areas[which] = area_of(status.task)
        self._has_ended[which], self._is_late[which] = status.state == "ended", status.end == "time_limit"
        self._quiet_until_ns[which] = mission.quiet_until_ns

    def _add_rewards(self, which: np.ndarray, record_of: Callable[[int], StepRecord]) -> None:
        of_robots = self.present[which], self._contact[which], self._positions_m[which]
        of_teams = self._explored[which], self._saved[which], self._areas[which]
        records = _RecordsOfStep(record_of)
        rewards = self._reward.of_step(Steps(records, which.copy(), *of_robots, *of_teams))
        records.is_over = True
        self._earned[which] += numbers_of("rewards", rewards, (len(which), len(self.robot_ids)))

    def _step_together(self, which: np.ndarray, commands: Commands) -> None:
        """Let the agents of plain missions act."""
        rows, senses = self._rows(which), self._senses
        sent = _Sent(commands, senses.percepts.poses[..., :2].copy())
        for k in range(self.rules.every):
            self._judge_together(which, sent, is_first=k == 0)
            self._core.move(commands.twists, which.tolist())
            state = self._core.sense(which.tolist())
            self._last = _Made(state, sent if k == 0 else None)
            self._must_judge[rows] = state.happened[rows] & _JUDGED != 0
            self._contact[rows], self._positions_m[rows] = state.contact[rows], state.positions_m[rows]
            self._times_ns[rows] += self.scenario.run.step_ns
            self._noise_left[rows] -= 1
            for i in which[self._noise_left[rows] == 0].tolist():
                self._noise_left[i] = self.check_begun(i).sensors.draw()
            if k == 0:
                hears = state.hop_count[rows] > 0  # links are symmetric
                senses.hear(rows, hears, sent.positions_m[rows], commands.say[rows], self._times_ns[rows])
            is_done = self._has_ended[rows] | (k + 1 == self.rules.every)
            if is_done.any():
                done = self._rows(which[is_done])
                senses.perceive_together(done, state, self._areas[done], self._times_ns[done])
                which = which[~is_done]
                rows = self._rows(which)
            if not which.size:
                break

    def _judge_together(self, which: np.ndarray, sent: _Sent, *, is_first: bool) -> None:
        """Complete the last step of plain missions, in which their agents decide this.

        Args: is_first: whether the messages are sent; else only the velocities are held.
        """
        self._judged, self._decided = self._last, (sent, is_first)
        rows = self._rows(which)
        self._passed[rows] += 1
        for i in which[self._must_judge[rows] | (self._times_ns[rows] >= self._quiet_until_ns[rows])].tolist():
            mission = self.check_begun(i)
            simulation, sensed = mission.simulation, mission.sensed
            if sensed is None:
                sensed = self._follow(i)
            mission.sensed, self._passed[i] = None, 0
            mission.record = simulation.judge(sensed, self._decisions(i))
            self._note_judged(i, simulation)
            if simulation.silence():
                self._put(i, mission)
                self._quiet_until_ns[i] = 0  # the record of the next step has the voice map
        self._add_rewards(which, self._last_record)

    def _follow(self, which: int) -> StepRecord:
        """Let the simulation of a plain mission catch up with its last judged step, and return what that has sensed."""
        steps, self._passed[which] = int(self._passed[which]), 0
        assert self._judged is not None
        state, sent = self._judged
        decisions = () if sent is None else sent.decisions(which, self.robot_ids)
        outboxes = [decision.outbox for decision in decisions]
        return self.check_begun(which).simulation.follow(steps, state.of(which), outboxes)

    def _decisions(self, which: int) -> tuple[Decision, ...]:
        """Return what the agents of a plain mission decided in the last step that was judged."""
        assert self._decided is not None
        sent, is_first = self._decided
        if is_first:
            return tuple(sent.decisions(which, self.robot_ids))
        return tuple(Decision(Twist(*twist)) for twist in sent.commands.twists[which].tolist())

    def _put(self, which: int, mission: _Mission) -> None:
        """Let a plain mission take part in the steps of the batch, as it is now."""
        simulation, world = mission.simulation, mission.simulation.world
        assert isinstance(world, World)
        links, ear = simulation.network.network.links, simulation.hearing.sensor.core()
        self._core.put(which, world.core, mission.sensors.core, links, ear, simulation.mission.places)
        self._noise_left[which] = mission.sensors.core.noise_left

    def _is_plain(self, which: int, mission: _Mission) -> bool:
        """Whether nothing but robots that obey acts in a mission, and no message is lost."""
        scenario, robots = mission.setup.scenario, mission.setup.robots
        others = scenario.fire is not None or scenario.schedule or scenario.base is not None or scenario.mission.exits
        walk = scenario.moves_people or any(victim.path for victim in scenario.mission.victims)
        doors = any(door.motion != "instant" for door in scenario.plan.doors) or bool(scenario.plan.passages)
        carried = any(robot.sensors or robot.laser.noise_m > 0.0 for robot in robots)
        return (
            self.watch is None
            and not believes(scenario.control)
            and scenario.run.world == "box2d"
            and self.robot_ids == list(range(len(robots)))
            and not (others or walk or doors or carried or scenario.mission.saved_by == "firefighter")
            and is_instant(scenario.network, len(robots), scenario.run.step_ns)
            and scenario.network.max_message_bytes >= LONGEST_MESSAGE + LONGEST_NUMBER * self.rules.said
            and not self._senses.looks(which)
        )

    def _rows(self, which: np.ndarray) -> Rows:
        """Return missions as an index; all of them as a slice, which NumPy does not copy."""
        return slice(None) if len(which) == self.number else which

    def state(self, which: int) -> np.ndarray:
        """Return the state of a mission, for central critics, float32, within [-1, 1].

        Per member of the team: present, x and y in the building, cosine and sine of the yaw; per victim: saved, safe or
        dead, x and y, of those from the start; per area: explored; then the share of the time limit that is over. It is
        that of the last complete step of the simulation, one before the observations.
        """
        self.check_begun(which)
        record, num_victims = self.record(which), len(self._setup.scenario.mission.victims)
        assert record is not None
        poses = np.where(record.present[:, None], record.state.true_pose, 0.0)
        team = np.column_stack((np.ones(len(poses)), self.observe.in_bounds(poses[:, :2]), *cos_sin(poses)))
        team[~record.present] = 0.0
        status = record.mission
        done = np.array([victim in OUT_OF_DANGER for victim in status.victims[:num_victims]], float)
        victims_m = np.array([victim.position for victim in record.victims[:num_victims]]).reshape(-1, 2)
        victims = np.column_stack((done, self.observe.in_bounds(victims_m)))
        time = status.time_s / self.scenario.mission.time_limit_s
        parts = (team.ravel(), victims.ravel(), np.array(status.explored, float), (time,))
        return np.clip(np.concatenate(parts), -1.0, 1.0).astype(np.float32)

    @property
    def state_size(self) -> int:
        """The size of `state`."""
        mission = self._setup.scenario.mission
        return 5 * len(self._setup.robots) + 3 * len(mission.victims) + len(mission.areas) + 1


def _checked(scenario: AnyScenario, rules: Rules) -> Scenario:
    """Return a scenario. Raises: RobotTeamSimError: it is invalid, or no mission of agents with these rules."""
    scenario = scenario if isinstance(scenario, Scenario) else load(scenario)
    check_headless(scenario)
    if not scenario.searcher_ids:
        raise LearningError(scenario.origin.line("robots.count: no robot can be driven", "robots.count"))
    arriving = [f"schedule.{i}.spawn" for i, event in enumerate(scenario.schedule) if event.spawn is not None]
    if arriving or not all(scenario.present_at_start):
        key = arriving[0] if arriving else "robots"
        text = f"{key}: a robot arrives later; expected robots that are present from the start"
        raise LearningError(scenario.origin.line(text, key))
    if scenario.control.mapping.starts == "unknown":
        key = "control.mapping.starts"
        raise LearningError(scenario.origin.line(f"{key}: 'unknown'; expected 'known', which agents need", key))
    if lack := rules.reward.lack_of(scenario):
        raise LearningError(scenario.origin.line(lack, lack.partition(":")[0]))
    return scenario
