"""Victims who walk: their positions as a function of time and seed."""

from __future__ import annotations

import itertools
import math
from bisect import bisect_right
from collections.abc import Iterator

import numpy as np

from robotteamsim.rng import stream
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.victims import Region, Victim
from robotteamsim.world.clearance import Solids

MAX_DRAWS = 1000
"""Draws for a place that can be reached in a straight line."""


class Walk:
    """The walk of one victim, at constant speed along straight lines, from their position at time 0.

    Places of `wander` are drawn from the stream ("victim", name), so that the walk depends only on plan, victim, seed.
    """

    def __init__(self, plan: FloorPlan, victim: Victim, seed: int) -> None:
        self._speed_mps = victim.speed_mps
        self._places = [victim.position]
        self._arrivals_s = [0.0]
        """Time of arrival at each of the places known so far."""
        if victim.wander is None:
            self._next_places = _along(victim)
        else:
            generator = stream(seed, "victim", victim.name)
            self._next_places = _random_places(plan, victim.position, victim.wander, generator)

    def position_m(self, time_s: float) -> Point:
        """Return the position in `map` at a time of the world, 0 or later [m]."""
        while self._arrivals_s[-1] <= time_s and (place := next(self._next_places, None)) is not None:
            leg_s = math.dist(self._places[-1], place) / self._speed_mps
            self._places.append(place)
            self._arrivals_s.append(self._arrivals_s[-1] + leg_s)
        index = bisect_right(self._arrivals_s, time_s)
        if index == len(self._places):
            return self._places[-1]
        (x0, y0), (x1, y1) = self._places[index - 1], self._places[index]
        left_s, arrives_s = self._arrivals_s[index - 1], self._arrivals_s[index]
        fraction = (time_s - left_s) / (arrives_s - left_s)
        return x0 + fraction * (x1 - x0), y0 + fraction * (y1 - y0)


class Walkers:
    """The victims of a trial who walk; nobody, if `people.People` moves them."""

    def __init__(self, scenario: Scenario) -> None:
        plan, mission, seed = scenario.plan, scenario.mission, scenario.run.seed
        self._update_ns = round(mission.walk_update_s * 1e9)
        self._updates = 0
        walking = [] if scenario.moves_people else [victim for victim in mission.victims if victim.walks]
        self._walks = {victim.name: Walk(plan, victim, seed) for victim in walking}

    def positions_due(self, sim_time_ns: int) -> dict[str, Point]:
        """Return the positions by name [m] in the first step whose stamp reaches an update, else nothing.

        They are those of the update's time, a multiple of `mission.walk_update_s`, and not of the stamp [ns].
        """
        updates = sim_time_ns // self._update_ns
        if not self._walks or updates == self._updates:
            return {}
        self._updates = updates
        time_s = updates * self._update_ns / 1e9
        return {name: walk.position_m(time_s) for name, walk in self._walks.items()}

    def stop(self, name: str) -> None:
        """Let a victim walk no more, if they do."""
        self._walks.pop(name, None)


def _along(victim: Victim) -> Iterator[Point]:
    return itertools.cycle(victim.path) if victim.loop else iter(victim.path)


def _random_places(plan: FloorPlan, start: Point, region: Region, generator: np.random.Generator) -> Iterator[Point]:
    """Yield places in a region, each in a straight line from the one before that no wall and no block crosses."""
    solids = Solids(plan, doors=False)
    low, high = region.box()
    before, here = None, start
    while True:
        for _ in range(MAX_DRAWS):
            x, y = generator.uniform(low, high).tolist()
            place = (x, y)
            if region.contains(place) and plan.bounds.contains(place) and solids.on_line(here, place) is None:
                break
        else:
            if before is None:
                return  # closed in: stays at the start
            place = before  # out of a narrow corner
        before, here = here, place
        yield place
