"""Which areas are left, and which one is explored next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.interface import Decision
from robotteamsim.interface.closed_area import closed_area_in
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Area


class AreaOrder:
    """The areas that are still to be explored.

    With `mission.area_order: given` they are named in the scenario's order. An area to which all robots report that
    they know no path is passed over: its turn comes again after the others. Base, firefighters, relays, and robots
    whose controllers were stopped do not report. A report counts until the robot sends a message without it.

    With another order each robot chooses its own areas, so the mission names none, and all that are left count.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._areas = scenario.mission.areas
        self._left = list(range(len(self._areas)))
        self._is_given = scenario.mission.area_order == "given"
        self.explored_by = () if self._is_given else (-1,) * len(self._areas)
        """The id of the robot that explored each area, -1 if none has; empty in the given order."""
        self._tried: set[int] = set()
        """The areas that were passed over since the last one was explored."""
        self._reporters = scenario.searcher_ids
        self._closed: dict[int, Point | None] = {}
        """The centre of the area in each robot's last report [m]; None if it reported none."""

    @property
    def target(self) -> int:
        """Index of the area that the task names; -1 if none is left, or if each robot chooses its own."""
        return self._left[0] if self._left and self._is_given else -1

    @property
    def area(self) -> Area | None:
        """The area that the task names; None if `target` is -1."""
        return self._areas[self.target] if self.target >= 0 else None

    @property
    def explored(self) -> tuple[bool, ...]:
        """Whether each area is explored."""
        return tuple(index not in self._left for index in range(len(self._areas)))

    @property
    def num_explored(self) -> int:
        """Number of explored areas."""
        return len(self._areas) - len(self._left)

    @property
    def can_be_explored(self) -> tuple[int, ...]:
        """Indices of the areas that count as explored once a robot is inside."""
        return tuple(self._left[:1] if self._is_given else self._left)

    def explore(self, index: int, robot_id: int) -> Area:
        """Note that a robot has explored an area, and return it."""
        self._tried.clear()
        self._left.remove(index)
        if not self._is_given:
            self.explored_by = (*self.explored_by[:index], robot_id, *self.explored_by[index + 1 :])
        return self._areas[index]

    def passed_over(self, decisions: Sequence[Decision], present: np.ndarray) -> Area | None:
        """Note the reports of a step; return the target if it is passed over now: the target is another one then."""
        if not (self._left and self._is_given):
            return None
        for robot_id in self._reporters:
            outbox = decisions[robot_id].outbox
            if outbox:
                self._closed[robot_id] = next(filter(None, (closed_area_in(m.payload) for m in outbox)), None)
        asked = [i for i in self._reporters if present[i] and not decisions[i].fault]
        center = self._areas[self.target].center
        if not asked or any(self._closed.get(robot_id) != center for robot_id in asked):
            return None
        self._tried.add(self.target)
        if self._tried.issuperset(self._left):
            return None
        self._left.append(self._left.pop(0))
        return self._areas[self._left[-1]]
