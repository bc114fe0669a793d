"""Many missions at once, as arrays."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from robotteamsim.learning.act import Commands
from robotteamsim.learning.arrays import array_of, shown
from robotteamsim.learning.episode import LARGEST_SEED, AnyScenario, Episode, Rules, vectors_of
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.together import BatchStep, Together

MOST_MISSIONS = 10_000
"""Each takes more than a megabyte."""


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
        firsts = [Episode(one, made) for one in scenarios]
        if made.teammates is None:
            made = msgspec.structs.replace(made, teammates=max(first.observe.teammates for first in firsts))
            firsts = [Episode(first.scenario, made) for first in firsts]
        for first in firsts[1:]:
            for key in ("observe", "act"):
                space, expected = getattr(first, key).space, getattr(firsts[0], key).space
                if space != expected:
                    name, one = first.scenario.name, firsts[0].scenario.name
                    raise LearningError(f"{name}: {key}: {space}; expected that of {one}, {expected}")
        self.num_envs, self.observe, self.act = int(num_envs), firsts[0].observe, firsts[0].act
        self.num_robots = max(len(first.robot_ids) for first in firsts)
        """How many robots a mission has room for."""
        more = (Episode(firsts[i % len(firsts)].scenario, made) for i in range(len(firsts), self.num_envs))
        self.episodes = [*firsts, *more]
        self._together = Together(self.episodes, self.num_robots, threads)
        self._same = [slice(k, None, len(firsts)) for k in range(len(firsts))]
        """The missions of each scenario, which are perceived together."""
        shape = self.num_envs, self.num_robots
        self._step = BatchStep(
            np.zeros((*shape, *self.observe.space.shape), np.float32),
            np.zeros(shape, np.float32),
            np.zeros(shape, bool),
            np.zeros(shape, bool),
            np.zeros(self.num_envs, bool),
        )

    @property
    def stepped_together(self) -> np.ndarray:
        """Which missions are stepped together, in arrays: those in which nothing acts but robots; shape (num_envs,)."""
        return self._together.are_plain

    @property
    def present(self) -> np.ndarray:
        """Whether each robot is present, bool, shape (num_envs, robots)."""
        self.episodes[-1].check_begun()
        present = np.zeros((self.num_envs, self.num_robots), bool)
        for row, episode in zip(present, self.episodes, strict=True):
            row[: len(episode.robot_ids)] = episode.present
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
        for rows, episode in zip(masks, self.episodes, strict=True):
            rows[: len(episode.robot_ids)] = [info["action_mask"] for info in episode.act.infos()]
        return masks

    def reset(self, seed: int | None = None) -> np.ndarray:
        """Begin all missions, mission i with `seed` + i, and return the observations; see `TeamEnv.reset`."""
        largest = LARGEST_SEED - self.num_envs + 1
        if seed is not None and not (isinstance(seed, int | np.integer) and 0 <= seed <= largest):
            raise LearningError(f"seed: {seed!r}; expected a whole number from 0 to {largest}")
        for i, episode in enumerate(self.episodes):
            episode.begin(None if seed is None else int(seed) + i)
            self._together.begin(i)
        for array in self._step[1:]:
            array[:] = 0
        self._perceive()
        return self._step.observations

    def begin(self, which: ArrayLike) -> np.ndarray:
        """Begin some missions now instead of in the next step, and return the observations of all.

        For libraries that reset environments themselves. Args: which: bool, shape (num_envs,).
        Raises: RobotTeamSimError: one line: `reset` was not called, or `which` is something else.
        """
        self.episodes[-1].check_begun()
        chosen = array_of(which)
        if chosen.shape != (self.num_envs,) or chosen.dtype != bool:
            found = f"which: {shown(chosen)}, shape {chosen.shape}"
            raise LearningError(f"{found}; expected bool, shape ({self.num_envs},)")
        for i in np.flatnonzero(chosen).tolist():
            self.episodes[i].begin()
            self._together.begin(i)
            for array in self._step[1:]:
                array[i] = 0
        self._perceive()
        return self._step.observations

    def step(self, actions: ArrayLike) -> BatchStep:
        """Let all robots act. Args: actions: shape (num_envs, robots, ...); those of absent robots are ignored.

        Raises: RobotTeamSimError: one line: `reset` was not called, or an action is not of the space. After any other
                error, such as one of a reward, only `reset` helps.
        """
        self.episodes[-1].check_begun()
        step, given = self._step, array_of(actions)
        shape = self.num_envs, self.num_robots, *(self.act.space.shape or ())
        if given.shape != shape:
            raise LearningError(f"actions of shape {given.shape}; expected {shape}")
        is_over = step.is_over.copy()
        acting = (self.present & ~is_over[:, None]).reshape(*shape[:2], *(1,) * (len(shape) - 2))
        commands = self._commands(np.where(acting, given, self.act.rest))
        for array in step[1:]:
            array[:] = 0
        for i in np.flatnonzero(is_over).tolist():
            self.episodes[i].begin()
            self._together.begin(i)
        try:
            self._together.step(np.flatnonzero(~is_over).tolist(), commands, step)
        except BaseException:  # some missions have made a part of a step
            for episode in self.episodes:
                episode.end()
            raise
        self._perceive()
        return step

    def _commands(self, actions: np.ndarray) -> Commands:
        """Return the commands of all missions. Raises: LearningError: an action is not of the space."""
        shape = self.num_envs, self.num_robots
        commands = Commands(np.zeros((*shape, 3)), np.zeros((*shape, self.act.said)))
        for same in self._same:
            first = self.episodes[same][0]
            of_these = actions[same, : len(first.robot_ids)]
            try:
                for array, part in zip(commands, first.act.commands(of_these), strict=True):
                    array[same, : part.shape[1]] = part
            except LearningError:
                # Name the mission.
                for i, of_one in zip(range(self.num_envs)[same], of_these, strict=True):
                    try:
                        first.act.commands(of_one)
                    except LearningError as error:
                        raise LearningError(f"mission {i}: {error}") from None
                raise
        return commands

    def _perceive(self) -> None:
        """Write the observations of all missions."""
        for same in self._same:
            first, present = self.episodes[same][0], np.stack([episode.present for episode in self.episodes[same]])
            percepts = self._together.percepts.of(same, len(first.robot_ids))
            self._step.observations[same, : present.shape[1]] = vectors_of(first.observe, percepts, present)
