"""The people on stairs, ramps and in lifts."""

from __future__ import annotations

import math
from typing import NamedTuple

from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import Way, both_ways, level_at


class _Trip(NamedTuple):
    """Somebody on a way, at whose end they may arrive from a time on."""

    way: Way
    until_ns: int


class PeoplePassages:
    """The people on their way from level to level, by name.

    They count as being where they left, but are no obstacle to others. Nobody enters stairs or a ramp on a level sooner
    after the one before than `Passage.headway_s`.
    """

    def __init__(self, plan: FloorPlan, step_ns: int) -> None:
        self._levels, self._step_ns = plan.levels, step_ns
        self._ways = both_ways(plan.levels, plan.passages, "people")
        self._trips: dict[str, _Trip] = {}
        self._free_ns: dict[Point, float] = {}
        """From when on the next one may enter at a stop."""

    def __contains__(self, name: str) -> bool:
        """Whether somebody is on a way."""
        return name in self._trips

    def ways_from(self, position: Point) -> list[Way]:
        """Return the ways that begin where somebody is."""
        return [way for way in self._ways if math.dist(way.start, position) <= way.passage.radius_m]

    def way_between(self, before: Point, after: Point) -> Way | None:
        """Return the way by which somebody has come from one place to another; None on one level, or without any."""
        if not self._levels or self.is_same_level(before, after):
            return None
        fitting = [way for way in self._ways if self.is_same_level(before, way.start)]
        fitting = [way for way in fitting if self.is_same_level(after, way.end)]
        return min(fitting, key=lambda way: math.dist(way.start, before) + math.dist(way.end, after), default=None)

    def is_same_level(self, first: Point, second: Point) -> bool:
        """Whether two places are on the same level."""
        return level_at(self._levels, first) is level_at(self._levels, second)

    def enter(self, name: str, way: Way, walking_mps: float, sim_time_ns: int) -> bool:
        """Let somebody who walks at this speed on level floor go, if there is room; return whether they do."""
        free_ns = self._free_ns.get(way.start, -math.inf)
        if sim_time_ns < free_ns:
            return False
        # What is left of the headway counts from when the stop was free, so that the flow does not depend on the step.
        self._free_ns[way.start] = max(free_ns, sim_time_ns - self._step_ns) + way.passage.headway_s * 1e9
        self._trips[name] = _Trip(way, sim_time_ns + round(way.time_s(walking_mps) * 1e9))
        return True

    def due(self, name: str, sim_time_ns: int) -> Way | None:
        """Return the way at whose end somebody may arrive now; None: later, or they are on none."""
        trip = self._trips.get(name)
        return trip.way if trip is not None and sim_time_ns >= trip.until_ns else None

    def leave(self, name: str) -> None:
        """Note that somebody is on no way any more."""
        self._trips.pop(name, None)
