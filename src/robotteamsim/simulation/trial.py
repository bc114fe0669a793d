"""One trial as observers follow it, from its first step to its result: totals of each robot, and the hash."""

from __future__ import annotations

import contextlib
import hashlib
import time
from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.setup import Setup
from robotteamsim.simulation.record import Observer, Result, RobotTotals, StepRecord
from robotteamsim.wording import counted

FASTEST_MPS, SHORTEST_JUMP_M = 20.0, 0.5
"""No robot is faster: twice the limit of a scenario. What is has jumped, as by a lift; shorter jumps are jitter."""


class TrajectoryHash:
    """SHA-256 over the true poses of all robots in every step: equal hashes mean equal bits.

    Of each step: the stamp as a little-endian int64 [ns], then x, y, qz, qw of each robot in id order as little-endian
    float64. It runs from the first step to the step in which the mission ended, both included.
    """

    def __init__(self) -> None:
        self._sha256 = hashlib.sha256()

    def update(self, sim_time_ns: int, true_poses: np.ndarray) -> None:
        """Add one step. Args: true_poses: shape (n, 4)."""
        self._sha256.update(sim_time_ns.to_bytes(8, "little", signed=True))
        self._sha256.update(np.ascontiguousarray(true_poses, "<f8").data)

    def hexdigest(self) -> str:
        """Return the hash of the steps so far, 64 hexadecimal digits."""
        return self._sha256.hexdigest()


class TeamTotals:
    """Totals of each robot, added up step by step."""

    def __init__(self, num_robots: int, step_s: float) -> None:
        self._core = _core.simulation.TeamTotals(num_robots, max(FASTEST_MPS * step_s, SHORTEST_JUMP_M))
        self._step_s = step_s

    def update(self, state: _core.state.State, excluded: Sequence[bool], running: bool) -> None:
        """Add a step. A stay counts only while the mission runs.

        Args:
            state:    of the team, as in `Sensed`; an absent robot does not count.
            excluded: whether each robot is excluded.
            running:  whether the mission runs.
        Raises: ValueError: not one entry per robot.
        """
        self._core.add_step(state, excluded, running)

    def result(self) -> tuple[RobotTotals, ...]:
        """Return the totals so far, in id order."""
        return tuple(
            RobotTotals(
                distance_m=robot.distance_m,
                contact_s=robot.contact_steps * self._step_s,
                excluded_s=robot.excluded_steps * self._step_s,
                longest_stay_s=robot.longest_stay_steps * self._step_s,
            )
            for robot in self._core.totals()
        )


class Trial:
    """Adds up the steps of a trial and reports each to the observers, until the mission has ended."""

    def __init__(self, setup: Setup, observers: Sequence[Observer]) -> None:
        """Begin. Raises: RecordingError: an observer cannot write; those that have begun have abandoned the trial."""
        self.result: Result | None = None
        """The result; None until the mission has ended."""
        self._scenario = setup.scenario
        self._hash = TrajectoryHash()
        self._totals = TeamTotals(self._scenario.team_size, self._scenario.run.step_s)
        self._wall_start_s = time.perf_counter()
        self._num_steps = 0
        self._observers: list[Observer] = []
        try:
            for observer in tuple(observers):
                self._observers.append(observer)
                observer.begin(setup)
        except BaseException:
            self.abandon()
            raise

    def add(self, record: StepRecord) -> None:
        """Add a step. Nothing changes after the end of the mission.

        Raises: ValueError: a step before it was not added, so that totals and hash would be of another mission.
        """
        if self.result is not None:
            return
        if record.step_index != self._num_steps + 1:
            others = f"the simulation made {counted(record.step_index - 1 - self._num_steps, 'step')} elsewhere"
            raise ValueError(f"{others}, which its result would lack; expected all steps of a new Simulation")
        self._num_steps += 1
        state, excluded = record.state, [decision.excluded for decision in record.decisions]
        self._hash.update(record.sim_time_ns, state.true_pose)
        self._totals.update(state, excluded, record.mission.state == "running")
        for observer in self._observers:
            observer.step(record)
        if record.mission.state == "ended":
            self.end(record)

    def end(self, last: StepRecord) -> Result:
        """End with this step, also where the mission goes on, and return the result."""
        result = self._result(last)
        while self._observers:
            self._observers[0].end(result)
            del self._observers[0]
        self.result = result
        return result

    def abandon(self) -> None:
        """Let the observers abandon an interrupted trial; no effect after the end of the mission."""
        with contextlib.ExitStack() as stack:  # also if one of them raises
            for observer in self._observers:
                stack.callback(observer.abandon)
            self._observers = []

    def _result(self, last: StepRecord) -> Result:
        status, run = last.mission, self._scenario.run
        delivered = status.delivered
        return Result(
            scenario=self._scenario.name,
            seed=run.seed,
            noise_db=last.noise_db,
            end=status.end,
            time_s=status.time_s,
            areas_explored=status.areas_explored,
            num_areas=len(status.explored),
            victims_saved=status.victims_saved,
            num_victims=len(status.victims),
            endangered_links=status.endangered_links,
            trajectory_hash=self._hash.hexdigest(),
            steps=last.step_index,
            sim_time_s=last.sim_time_s,
            robots=self._totals.result(),
            wall_s=time.perf_counter() - self._wall_start_s,
            discoveries_delivered=delivered.count if delivered else None,
            mean_delivery_delay_s=delivered.mean_delay_s if delivered and delivered.count else None,
            max_delivery_delay_s=delivered.max_delay_s if delivered and delivered.count else None,
            victims_dead=status.victims.count("dead"),
            egress=last.egress,
        )
