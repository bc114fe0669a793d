"""What is added up over a trial and becomes its result, in headless runs and in ROS runs alike."""

from __future__ import annotations

import time
from itertools import chain
from operator import itemgetter

import numpy as np

from robotteamsim.interface import Decision
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import contact_flags, ground_truth_rows
from robotteamsim.simulation.record import Result, StepRecord
from robotteamsim.simulation.team_totals import TeamTotals
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

_PENDING_STEPS = 64
"""So many steps are added up at once: one by one, between the other stages, each would find cold code."""

# By index, as names of a tuple's items take several times as long.
_ADDED_UP = itemgetter(
    *[StepRecord._fields.index(name) for name in ("sim_time_ns", "readings", "decisions", "mission")]
)
_EXCLUDED = itemgetter(Decision._fields.index("excluded"))

_Step = tuple[int, np.ndarray, np.ndarray, list[bool], bool]
"""What is added up of a step: its stamp [ns], the rows of true poses, who touches something, who is excluded, whether
the mission runs; of readings no more than that, so that their memory is free for the next ones."""


class Tally:
    """Adds up the steps of one trial, from the first to the one in which the mission ended."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._hash = TrajectoryHash()
        self._figures = TeamTotals(scenario.num_robots, scenario.run.step_s)
        self._wall_start_s = time.perf_counter()
        self._last: StepRecord | None = None
        self._pending: list[_Step] = []

    def add(self, record: StepRecord) -> None:
        """Take in one step."""
        self._last = record
        sim_time_ns, readings, decisions, mission = _ADDED_UP(record)
        rows, in_contact = ground_truth_rows(readings), contact_flags(readings)
        self._pending.append(
            (sim_time_ns, rows, in_contact, list(map(_EXCLUDED, decisions)), mission.state == "running")
        )
        if len(self._pending) >= _PENDING_STEPS:
            self._add_pending()

    def result(self) -> Result:
        """Return the result as of the last step. Raises: ValueError: there was no step yet."""
        if self._last is None:
            raise ValueError("a trial without a step has no result")
        self._add_pending()
        record, status = self._last, self._last.mission
        reports = status.reports
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
            robots=self._figures.result(),
            wall_s=time.perf_counter() - self._wall_start_s,
            finds_reported=reports.reported if reports else None,
            mean_report_delay_s=reports.mean_delay_s if reports and reports.reported else None,
            max_report_delay_s=reports.max_delay_s if reports and reports.reported else None,
        )

    def _add_pending(self) -> None:
        if not self._pending:
            return
        sim_times_ns, rows, in_contact, excluded, running = zip(*self._pending, strict=True)
        shape = (len(rows), len(rows[0]))
        ground_truth = np.concatenate(rows).reshape(*shape, 4)
        self._hash.update_all(sim_times_ns, ground_truth)
        self._figures.update(
            ground_truth[:, :, :2],
            np.concatenate(in_contact).reshape(shape),
            np.fromiter(chain.from_iterable(excluded), bool).reshape(shape),
            np.array(running),
        )
        self._pending.clear()
