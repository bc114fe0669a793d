"""People move after the world, by what the mission knew at the end of the last step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.control.driving.hot_places import BLOCK_M, REPLAN_NS, Block
from robotteamsim.hazards import HazardField, walking_speed_share
from robotteamsim.interface import Assistance
from robotteamsim.mission.status import OUT_OF_DANGER, VictimState
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import People, PersonState


class PeopleStage:
    """The people of one trial. The headless loop and the world node step this same class."""

    def __init__(self, scenario: Scenario) -> None:
        self._people = People(scenario)
        self._collapsed: set[str] = set()
        self._hot: set[Block] = set()
        self._next_ns = 0

    @property
    def states(self) -> tuple[PersonState, ...]:
        """The people as of the last update; the same object until the next one."""
        return self._people.states

    def step(
        self,
        sim_time_ns: int,
        positions_m: np.ndarray,
        doors: DoorStates,
        victims: Sequence[VictimState],
        assistance: Sequence[Assistance],
        field: HazardField | None = None,
    ) -> None:
        """Move everybody for the step that ends at this time [ns].

        Args: positions_m: of robots and firefighters after it, shape (n, 2) [m].
              victims, assistance: of the mission after the step before; empty if they are not known.
              field: fire and smoke; None if nothing can burn.
        """
        states = list(zip(self._people.names, victims, strict=False))
        collapsed = [name for name, state in states if state == "collapsed"]
        collapsed += [helped.victim for helped in assistance if helped.collapsed]
        for name in collapsed:
            if name not in self._collapsed:
                self._collapsed.add(name)
                self._people.collapse(name)
        if field is not None:
            self._feel(field, sim_time_ns)
        settled = {name for name, state in states if state in OUT_OF_DANGER}
        settled |= {helped.victim for helped in assistance if not helped.moving}
        helpers = {helped.victim: helped.robot_id for helped in assistance if helped.moving}
        self._people.step(sim_time_ns, positions_m, doors, helpers, settled)

    def _feel(self, field: HazardField, sim_time_ns: int) -> None:
        """Let smoke slow everybody down [frantzich2003], and nobody flee through heat, which all of them see."""
        extinction_per_m = field.extinction_per_m(self._people.positions_m)
        self._people.slow_down(walking_speed_share(extinction_per_m).tolist())
        if sim_time_ns < self._next_ns:
            return
        self._next_ns = sim_time_ns + REPLAN_NS
        hot = np.argwhere(field.temperatures_c >= field.fire.heat.block_c) + 0.5
        blocks = np.floor(hot * field.resolution_m / BLOCK_M).astype(int).tolist()
        known = self._hot | {(row, column) for row, column in blocks}
        if known != self._hot:
            self._hot = known
            self._people.avoid(tuple(sorted(known)))

    def place(self, name: str, position_m: Point) -> None:
        """Add a person, or move the one of that name [m, map], who then stays there."""
        self._people.place(name, position_m)
        self._collapsed.discard(name)
