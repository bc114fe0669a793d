"""The totals of a trial that become its result, in headless runs and in ROS runs."""

from __future__ import annotations

import time

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation.record import Result, StepRecord
from robotteamsim.simulation.team_totals import TeamTotals
from robotteamsim.simulation.trajectory_hash import TrajectoryHash


class Tally:
    """Adds up the steps of one trial, from the first to the one in which the mission ends."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._hash = TrajectoryHash()
        self._totals = TeamTotals(scenario.team_size, scenario.run.step_s)
        self._wall_start_s = time.perf_counter()
        self._last: StepRecord | None = None

    def add(self, record: StepRecord) -> None:
        """Add one step."""
        self._last = record
        state, excluded = record.readings.state, [decision.excluded for decision in record.decisions]
        self._hash.update(record.sim_time_ns, state.true_pose)
        self._totals.update(state, excluded, record.mission.state == "running")

    def result(self) -> Result:
        """Return the result as of the last step. Raises: ValueError: there was no step yet."""
        if self._last is None:
            raise ValueError("a trial without steps has no result")
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
