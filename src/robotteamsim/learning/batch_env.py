"""Many missions at once, as arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from robotteamsim.learning.act import Commands
from robotteamsim.learning.arrays import array_of, shown
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.missions import LARGEST_SEED, Missions
from robotteamsim.learning.rules import AnyScenario, Rules
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord

MOST_MISSIONS = 10_000
"""Each takes more than a megabyte."""


class BatchStep(NamedTuple):
    """What a step of many missions has led to.

    observations: float32, shape (num_envs, robots, size); 0 for absent robots.
    rewards:      float32, shape (num_envs, robots).
    terminated, truncated: bool, shape (num_envs, robots), as of `TeamEnv`.
    is_over:      bool, shape (num_envs,): whose next step begins another mission.
    """

    observations: np.ndarray
    rewards: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    is_over: np.ndarray


class BatchEnv:
    """Many missions that are stepped together: of one scenario, or of several in turn, each with seeds of its own.

    A mission that is over begins again in the next step, which ignores its actions and has no reward (Gymnasium's
    autoreset mode NEXT_STEP). Robots are those that obey actions, in id order; smaller teams leave the last rows empty.
    Mission i has the same bits as a `TeamEnv` of its scenario with the batch's seed + i.
    """

    def __init__(
        self, scenario: AnyScenario | Sequence[AnyScenario], num_envs: int, *, threads: int = 1, **rules: Any
    ) -> None:
        """Make the missions; `reset` begins them.

        Args:   scenario: one, or several: mission i is of number i modulo their number.
                threads: that move missions and let them measure, 0: one per core; the results are the same.
                rules: those of `parallel_env`; there is room for the teammates of the largest team unless given.
        Raises: RobotTeamSimError: as `parallel_env`, or the scenarios have different spaces.
        """
        cores = os.cpu_count() or 1
        for key, value, least, most in (("num_envs", num_envs, 1, MOST_MISSIONS), ("threads", threads, 0, cores)):
            is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
            if not is_whole or not least <= value <= most:
                of = ", the cores of this machine" if key == "threads" else ""
                raise LearningError(f"{key}: {value!r:.60}; expected a whole number from {least} to {most}{of}")
        scenarios = list(scenario) if isinstance(scenario, Sequence) and not isinstance(scenario, str) else [scenario]
        if not 1 <= len(scenarios) <= num_envs:
            raise LearningError(
                f"scenario: {len(scenarios)} scenarios for {num_envs} missions; expected 1 to {num_envs}"
            )
        made = Rules.of(rules)
        firsts = [Missions(one, made) for one in scenarios]
        made = msgspec.structs.replace(made, teammates=max(first.observe.teammates for first in firsts))
        self._same = [slice(k, int(num_envs), len(firsts)) for k in range(len(firsts))]
        """The missions of each scenario, which are stepped together."""
        self._groups = [
            Missions(first.scenario, made, len(range(num_envs)[same]), threads)
            for first, same in zip(firsts, self._same, strict=True)
        ]
        first, *others = self._groups
        for other in others:
            for key in ("observe", "act"):
                space, expected = getattr(other, key).space, getattr(first, key).space
                if space != expected:
                    name, one = other.scenario.name, first.scenario.name
                    raise LearningError(f"{name}: {key}: {space}; expected that of {one}, {expected}")
        self.num_envs, self.observe, self.act = int(num_envs), first.observe, first.act
        self.num_robots = max(len(group.robot_ids) for group in self._groups)
        """How many robots a mission has room for."""
        self._is_over = np.zeros(self.num_envs, bool)

    @property
    def stepped_together(self) -> np.ndarray:
        """Which missions are stepped together, in arrays: those in which nothing acts but robots; shape (num_envs,)."""
        together = np.zeros(self.num_envs, bool)
        for group, same in self._grouped():
            together[same] = group.are_plain
        return together

    @property
    def present(self) -> np.ndarray:
        """Whether each robot is present, bool, shape (num_envs, robots)."""
        self._check_begun()
        present = np.zeros((self.num_envs, self.num_robots), bool)
        for group, same in self._grouped():
            present[same, : len(group.robot_ids)] = group.present
        return present

    @property
    def action_mask(self) -> np.ndarray | None:
        """Which actions each robot can choose, int8, shape (num_envs, robots, actions); 1 in rows without a robot.

        None if `Act.infos` has no `action_mask`.
        """
        first = self.act.infos()[0].get("action_mask")
        if first is None:
            return None
        masks = np.ones((self.num_envs, self.num_robots, *np.shape(first)), np.int8)
        for group, same in self._grouped():
            masks[same, : len(group.robot_ids)] = [info["action_mask"] for info in group.act.infos()]
        return masks

    def record(self, mission: int) -> StepRecord | None:
        """Return the last complete step of a mission, for own measures; None before the first, and after an error."""
        group, which = self._place(mission)
        return group.record(which)

    def setup(self, mission: int) -> Setup:
        """Return the setup of a mission, whose `scenario.run.seed` is its seed. Raises: LearningError: see `reset`."""
        group, which = self._place(mission)
        return group.setup(which)

    def reset(self, seed: int | None = None) -> np.ndarray:
        """Begin all missions, mission i with `seed` + i, and return the observations; see `TeamEnv.reset`."""
        largest = LARGEST_SEED - self.num_envs + 1
        if seed is not None and not (isinstance(seed, int | np.integer) and 0 <= seed <= largest):
            raise LearningError(f"seed: {seed!r}; expected a whole number from 0 to {largest}")
        for i in range(self.num_envs):
            self._begin(i, None if seed is None else int(seed) + i)
        self._is_over = np.zeros(self.num_envs, bool)
        return self._observations()

    def begin(self, which: ArrayLike) -> np.ndarray:
        """Begin some missions now instead of in the next step, and return the observations of all.

        For libraries that reset environments themselves. Args: which: bool, shape (num_envs,).
        Raises: RobotTeamSimError: one line: `reset` was not called, or `which` is something else.
        """
        self._check_begun()
        chosen = array_of(which)
        if chosen.shape != (self.num_envs,) or chosen.dtype != bool:
            found = f"which: {shown(chosen)}, shape {chosen.shape}"
            raise LearningError(f"{found}; expected bool, shape ({self.num_envs},)")
        for i in np.flatnonzero(chosen).tolist():
            self._begin(i)
        self._is_over = self._is_over & ~chosen
        return self._observations()

    def step(self, actions: ArrayLike) -> BatchStep:
        """Let all robots act. Args: actions: shape (num_envs, robots, ...); those of absent robots are ignored.

        Raises: RobotTeamSimError: one line: `reset` was not called, or an action is not of the space. After any other
                error, such as one of a reward, only `reset` helps.
        """
        given, present, was_over = array_of(actions), self.present, self._is_over
        shape, of_action = (self.num_envs, self.num_robots), self.act.space.shape or ()
        if given.shape != (*shape, *of_action):
            raise LearningError(f"actions of shape {given.shape}; expected {(*shape, *of_action)}")
        acting = (present & ~was_over[:, None]).reshape(*shape, *(1 for _ in of_action))
        given = np.where(acting, given, self.act.rest)
        commands = [self._commands(group, same, given) for group, same in self._grouped()]
        for i in np.flatnonzero(was_over).tolist():
            self._begin(i)
        rewards, (terminated, truncated) = np.zeros(shape, np.float32), np.zeros((2, *shape), bool)
        self._is_over = is_over = np.zeros(self.num_envs, bool)
        for (group, same), of_these in zip(self._grouped(), commands, strict=True):
            which = np.flatnonzero(~was_over[same])
            where = np.arange(self.num_envs)[same][which]
            *of_agents, is_over[where] = group.step(which, of_these)
            for array, part in zip((rewards, terminated, truncated), of_agents, strict=True):
                array[where, : part.shape[1]] = part
        return BatchStep(self._observations(), rewards, terminated, truncated, is_over)

    def _grouped(self) -> Iterator[tuple[Missions, slice]]:
        return zip(self._groups, self._same, strict=True)

    def _place(self, mission: int) -> tuple[Missions, int]:
        """Return where a mission is. Raises: LearningError: there is no such mission."""
        if mission not in range(self.num_envs):
            raise LearningError(f"there is no mission {mission!r:.60}; expected 0 to {self.num_envs - 1}")
        return self._groups[mission % len(self._groups)], mission // len(self._groups)

    def _begin(self, mission: int, seed: int | None = None) -> None:
        group, which = self._place(mission)
        group.begin(which, seed)

    def _check_begun(self) -> None:
        """Raises: LearningError: `reset` was not called, or did not end."""
        for group in self._groups:
            group.check_all_begun()

    def _commands(self, group: Missions, same: slice, actions: np.ndarray) -> Commands:
        """Return the commands of the missions of a scenario. Raises: LearningError: an action is not of the space."""
        of_these = actions[same, : len(group.robot_ids)]
        try:
            return group.act.commands(of_these)
        except LearningError:
            # Name the mission.
            for i, of_one in zip(range(self.num_envs)[same], of_these, strict=True):
                try:
                    group.act.commands(of_one)
                except LearningError as error:
                    raise LearningError(f"mission {i}: {error}") from None
            raise

    def _observations(self) -> np.ndarray:
        """Return the observations of all missions."""
        observations = np.zeros((self.num_envs, self.num_robots, *self.observe.space.shape), np.float32)
        for group, same in self._grouped():
            observations[same, : len(group.robot_ids)] = group.vectors()
        return observations
