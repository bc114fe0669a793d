"""Boustrophedon: the team sweeps the floor in parallel lines, back and forth [choset2000]."""

from __future__ import annotations

from robotteamsim.control.baselines.searching import RouteController
from robotteamsim.control.baselines.sweep import shares, sweep
from robotteamsim.control.driving.localisation import body_of
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector
from robotteamsim.world.placement import placed_robots


class BoustrophedonController(RouteController):
    """Sweeps its share of the floor, then those of the other robots in turn; it sends no messages.

    All robots compute the same sweep from the start of robot 0 and begin at equal distances along it. A voice that is
    heard interrupts the sweep.
    """

    def __init__(self, robot_id: int, scenario: Scenario) -> None:
        """Raises: ScenarioError: robot 0 cannot leave its start."""
        super().__init__(robot_id, scenario, scenario.control.sweep)
        start = placed_robots(scenario)[0].start_pose[:2]
        spacing_m = scenario.control.sweep.spacing_m
        segments = sweep(scenario.plan, body_of(robot_id, scenario).reach_m, spacing_m, start)
        if not segments:
            raise ScenarioError(
                f"{scenario.name}: control.sweep.spacing_m: no line of the sweep crosses floor that robots can reach"
            )
        self._places = [end for segment in segments for end in segment]
        self._index = 2 * shares(segments, scenario.num_robots)[robot_id]

    def _next_place(self, position: Vector, is_done: bool) -> Vector:
        if is_done:
            self._index = (self._index + 1) % len(self._places)
        return self._places[self._index]
