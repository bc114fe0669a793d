"""The totals of a trial that become its result, in headless runs and in ROS runs."""

from __future__ import annotations

import time
from operator import attrgetter

import msgspec
import numpy as np

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import reading_rows
from robotteamsim.simulation.record import Result, StepRecord
from robotteamsim.simulation.team_totals import TeamTotals
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

_PENDING_STEPS = 64
"""Steps are added up in blocks of this many: NumPy calls cost about the same for one step as for many."""


_EXCLUDED = attrgetter("excluded")


class _Step(msgspec.Struct, frozen=True, gc=False, eq=False):
    """The values of a step that are added up. The record itself is not kept, so that its scans are freed.

    rows: as in `TeamReadings`.  running: whether the mission runs.
    """

    sim_time_ns: int
    rows: np.ndarray
    excluded: list[bool]
    running: bool


class Tally:
    """Adds up the steps of one trial, from the first to the one in which the mission ends."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._hash = TrajectoryHash()
        self._totals = TeamTotals(scenario.team_size, scenario.run.step_s)
        self._wall_start_s = time.perf_counter()
        self._last: StepRecord | None = None
        self._pending: list[_Step] = []

    def add(self, record: StepRecord) -> None:
        """Add one step."""
        self._last = record
        self._pending.append(
            _Step(
                record.sim_time_ns,
                reading_rows(record.readings),
                list(map(_EXCLUDED, record.decisions)),
                record.mission.state == "running",
            )
        )
        if len(self._pending) >= _PENDING_STEPS:
            self._add_pending()

    def result(self) -> Result:
        """Return the result as of the last step. Raises: ValueError: there was no step yet."""
        if self._last is None:
            raise ValueError("a trial without steps has no result")
        self._add_pending()
        record, status = self._last, self._last.mission
        delivered = status.delivered
        return Result(
            scenario=self._scenario.name,
            seed=self._scenario.run.seed,
            noise_db=record.noise_db,
            end=status.end,
            time_s=status.time_s,
            areas_explored=status.areas_explored,
            num_areas=len(status.explored),
            victims_saved=status.victims_saved,
            num_victims=len(status.victims),
            endangered_links=status.endangered_links,
            trajectory_hash=self._hash.hexdigest(),
            steps=record.step_index,
            sim_time_s=record.sim_time_s,
            robots=self._totals.result(),
            wall_s=time.perf_counter() - self._wall_start_s,
            discoveries_delivered=delivered.count if delivered else None,
            mean_delivery_delay_s=delivered.mean_delay_s if delivered and delivered.count else None,
            victims_dead=status.victims.count("dead"),
            max_delivery_delay_s=delivered.max_delay_s if delivered and delivered.count else None,
        )

    def _add_pending(self) -> None:
        if not self._pending:
            return
        steps = self._pending
        rows = np.stack([step.rows for step in steps])
        self._hash.update_all([step.sim_time_ns for step in steps], rows[:, :, :4])
        self._totals.update(
            np.ascontiguousarray(rows[:, :, :2]),
            rows[:, :, 23] > 0.0,
            np.array([step.excluded for step in steps], dtype=bool),
            np.array([step.running for step in steps]),
        )
        self._pending = []
