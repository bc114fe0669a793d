"""When a robot drives to the last area early, so that the team does not wait for it at the end."""

from __future__ import annotations

from robotteamsim import _core
from robotteamsim.control.search.areas import Areas
from robotteamsim.control.search.cells import NO_CELL
from robotteamsim.control.search.team import Teammates

_OVERHEAD = 4.0
"""The end of a search takes this many times as long as if no floor were heard twice and every drive led over new floor;
chosen with the seeds 1 to 20 of the garage."""

_HYSTERESIS = 0.7
"""A robot that already drives to the last area stops only if its path is at most this share of the allowed length."""


class EarlyDrive:
    """Whether one robot drives to the last area, because even the nearest one would be late otherwise."""

    def __init__(self) -> None:
        self._is_on = False

    def is_needed(
        self, areas: Areas, team: Teammates, paths: _core.control.CellPaths, start: int, search_m: float
    ) -> bool:
        """Return whether the robot drives to the last area now.

        It does if it is the nearest one, and its path is longer than both that through the areas before the last one
        and that until the search is over.

        Args: start: the cell of the robot.
              search_m: how far each robot drives until the team has searched the remaining floor, if all goes well [m].
        """
        was_on, self._is_on = self._is_on, False
        if areas.num_left < 2 or not areas.is_possible or areas.last_cell == NO_CELL or start == NO_CELL:
            return False
        length_m, robot_id = min(team.lengths_m(areas.last_cell, start, paths, ("search", "voice", "wait")))
        to_next_m, _ = min(team.lengths_m(areas.cell, start, paths))
        allowed_m = max(to_next_m + areas.tour_m - areas.last_leg_m, _OVERHEAD * search_m)
        self._is_on = robot_id == team.robot_id and length_m > (_HYSTERESIS if was_on else 1.0) * allowed_m
        return self._is_on
