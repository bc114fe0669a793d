"""What is added up over a trial and becomes its result, in headless runs and in ROS runs alike."""

from __future__ import annotations

import time

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import ground_truth_rows
from robotteamsim.simulation.figures import TeamFigures
from robotteamsim.simulation.record import Result, StepRecord
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

_PENDING_ROBOTS = 200
"""Steps are added up in lots of so many robots: one by one, between the other stages, each would find cold code."""


class Tally:
    """Adds up the steps of one trial, from the first to the one in which the mission ended."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._hash = TrajectoryHash()
        num_robots = len(scenario.placed_robots())
        self._figures = TeamFigures(num_robots, scenario.run.step_s)
        self._wall_start_s = time.perf_counter()
        self._last: StepRecord | None = None
        self._pending: list[StepRecord] = []
        self._max_pending = max(1, _PENDING_ROBOTS // num_robots)

    def add(self, record: StepRecord) -> None:
        """Take in one step."""
        self._last = record
        self._pending.append(record)
        if len(self._pending) >= self._max_pending:
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
        for record in self._pending:
            self._hash.update(record.sim_time_ns, ground_truth_rows(record.readings))
            self._figures.update(record.readings, record.decisions, record.mission.state == "running")
        self._pending.clear()
