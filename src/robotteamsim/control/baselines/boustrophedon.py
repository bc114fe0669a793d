"""Boustrophedon: the team sweeps the floor in parallel lines, back and forth [choset2000]."""

from __future__ import annotations

from robotteamsim.control.baselines.searching import RouteController
from robotteamsim.control.baselines.sweep import shares, sweep
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.controllers.routes import BoustrophedonControl
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


class BoustrophedonController(RouteController):
    """Sweeps its share of the floor, then those of the other robots in turn; it sends no messages.

    All robots compute the same sweep from the start of robot 0 and begin at equal distances along it. A voice that is
    heard interrupts the sweep.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        """Raises: ScenarioError: robot 0 cannot leave its start."""
        scenario = setup.scenario
        control = scenario.control.as_kind(BoustrophedonControl)
        super().__init__(robot_id, setup, control)
        spacing_m = control.spacing_m
        segments = setup.building.shared(sweep, setup.robots[robot_id].reach_m, spacing_m, setup.start_m(0))
        if not segments:
            raise ScenarioError(
                f"{scenario.name}: control.spacing_m: no line of the sweep crosses floor that robots can reach"
            )
        self._places = [end for segment in segments for end in segment]
        self._index = 2 * shares(segments, scenario.num_robots)[robot_id]

    def _next_place(self, position: Vector, is_done: bool) -> Vector:
        if is_done:
            self._index = (self._index + 1) % len(self._places)
        return self._places[self._index]
