"""People who move: they stay, walk, flee to exits, follow a firefighter, or are carried."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Literal

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building, Doors
from robotteamsim.scenario.fire import BLOCK_M, Block
from robotteamsim.scenario.levels import Way, places_at_end, portals
from robotteamsim.scenario.people import People as PeopleSection
from robotteamsim.scenario.plan import FREE
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.victims import Victim
from robotteamsim.world.core_parts import core_solids
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people_passages import PeoplePassages
from robotteamsim.world.walking import Walk

Motion = Literal["stands", "walks", "enclosed"]

_CELL_M = 0.1
_PER_BLOCK = round(BLOCK_M / _CELL_M)
"""Cells along the side of a block."""
_MARGIN_M = 0.05
"""Clearance of paths in addition to a person's radius."""
_TRAIL_STEP_M = 0.3
"""Distance between the places of a firefighter that followers keep in mind."""
_EQUAL_M = 1e-3
"""Paths whose lengths differ by less are equal: lengths are float32."""


class PersonState(msgspec.Struct, frozen=True):
    """Where a person is, in `map` [m].

    motion: walks: on their own, to an exit or along their path; enclosed: would flee, but no path to an exit is open.
    """

    name: str
    position_m: Point
    motion: Motion


class _Person:
    """One person, with what they need to move on."""

    def __init__(self, victim: Victim, walk: Walk | None) -> None:
        self.victim = victim
        self.position = victim.position
        self.motion: Motion = "stands"
        self.walk = walk
        self.trail: list[Point] = []
        self.speed_share = 1.0


class People:
    """Moves all people of a trial, the victims, after each step of the world.

    People who flee or follow move by the collision-free speed model, around robots, firefighters and each other, and
    take stairs and ramps to other levels. Those who have a `path` or `wander` walk along it. Positions become known to
    others every `mission.walk_update_s`.
    """

    def __init__(self, scenario: Scenario, robots: Sequence[PlacedRobot], building: Building) -> None:
        mission = scenario.mission
        self._building, self._tuning = building, scenario.people
        self._exits_m = tuple(way_out.center for way_out in mission.exits)
        self._seed = scenario.run.seed
        self._step_ns = scenario.run.step_ns
        self._update_ns = round(mission.walk_update_s * 1e9)
        self._updates = -1
        self._reaches_m = np.array([robot.reach_m for robot in robots])
        self._crowd = _core.world.Crowd(*core_solids(scenario.plan), crowd_parameters(scenario.people))
        self._passages = PeoplePassages(scenario.plan, self._step_ns)
        self._persons = {victim.name: self._person(victim) for victim in mission.victims}
        self._states: tuple[PersonState, ...] = ()
        self.version = 0
        """Number of updates of `states`."""
        self._hot: tuple[Block, ...] = ()
        self._doors = DoorStates.at_start(scenario.plan)
        self._find_grid()

    @property
    def positions_m(self) -> np.ndarray:
        """Where everybody is now, in the order of `names`, float64, shape (n, 2), in `map` [m]."""
        return np.array([person.position for person in self._persons.values()]).reshape(-1, 2)

    @property
    def states(self) -> tuple[PersonState, ...]:
        """The people as of the last update."""
        return self._states

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all people, in the order in which they were added, as in the mission."""
        return tuple(self._persons)

    def step(
        self,
        sim_time_ns: int,
        bodies_m: np.ndarray,
        doors: DoorStates,
        helpers: Mapping[str, int],
        settled: Collection[str],
    ) -> None:
        """Move everybody for one step, which ends at this time [ns].

        Args: bodies_m: positions of robots and firefighters after it, shape (n, 2), in `map` [m]; NaN where absent.
              helpers:  who carries or leads whom: id of a firefighter by name of a person.
              settled:  names of people who no longer move, because they are safe, dead, or being picked up.
        """
        changed, self._doors = doors.changes_since(self._doors), doors
        if changed:
            self._find_grid()
        grid = self._grid
        walkers: list[tuple[_Person, Point]] = []
        for name, person in self._persons.items():
            helper = helpers.get(name)
            if name in settled:
                person.motion = "stands"
                self._passages.leave(name)
                continue
            target = self._target(person, sim_time_ns, grid, None if helper is None else bodies_m[helper])
            if target is not None:
                walkers.append((person, target))
        if walkers:
            gone = {*settled, *helpers}
            walking = {person.victim.name for person, _ in walkers}
            standing = [
                p.position
                for name, p in self._persons.items()
                if name not in gone and name not in walking and name not in self._passages
            ]
            self._walk(walkers, standing, bodies_m, doors)
        self._arrive(sim_time_ns, bodies_m, settled)
        updates = sim_time_ns // self._update_ns
        if updates != self._updates:
            self._updates = updates
            self.version += 1
            self._states = tuple(
                PersonState(name, person.position, person.motion) for name, person in self._persons.items()
            )

    def avoid(self, hot: tuple[Block, ...]) -> None:
        """Let nobody flee through these blocks."""
        self._hot = hot
        self._find_grid()

    def slow_down(self, shares: Sequence[float]) -> None:
        """Let everybody walk at a share of their speed, in the order of `names`."""
        for person, share in zip(self._persons.values(), shares, strict=True):
            person.speed_share = share

    def collapse(self, name: str) -> None:
        """Let a person walk no more; a firefighter has to carry them."""
        person = self._persons[name]
        person.victim = person.victim.model_copy(update={"flees": False, "can_walk": False})
        person.walk = None
        self._passages.leave(name)

    def place(self, name: str, position_m: Point) -> None:
        """Add a person, or move the one of that name [m, map], who then stays there."""
        self._passages.leave(name)
        self._persons[name] = self._person(Victim(name=name, position=position_m))

    def _find_grid(self) -> None:
        self._grid = self._grid_around(self._hot)

    def _grid_around(self, hot: tuple[Block, ...]) -> _Grid:
        doors = tuple(self._doors.closed().items())
        return self._building.shared(_Grid, self._tuning.radius_m, doors, hot)

    def _person(self, victim: Victim) -> _Person:
        return _Person(victim, Walk(self._building.plan, victim, self._seed) if victim.walks else None)

    def _target(self, person: _Person, sim_time_ns: int, grid: _Grid, helper_m: np.ndarray | None) -> Point | None:
        """Return where a person walks by the model; None: they do not, and have been moved if they move otherwise."""
        victim = person.victim
        person.motion = "stands"
        if helper_m is None:
            person.trail.clear()  # the next helper leads from somewhere else
        else:
            helper = (float(helper_m[0]), float(helper_m[1]))
            if math.isnan(helper[0]):
                return None
            if victim.can_walk:
                return self._behind(person, helper, sim_time_ns, grid)
            self._passages.leave(victim.name)
            person.position = helper
            return None
        if victim.name in self._passages:
            person.motion = "walks"
            return None
        if victim.flees and sim_time_ns >= victim.flees_after_s * 1e9:
            target = grid.towards_exit(self._exits_m, person.position, self._tuning.look_ahead_m)
            person.motion = "enclosed" if target is None else "walks"
            by_way = [way for way in self._passages.ways_from(person.position) if grid.leads_by(way, self._exits_m)]
            return None if by_way and self._enters(person, by_way[0], sim_time_ns) else target
        if person.walk is not None:
            person.motion = "walks"
            person.position = person.walk.position_m(sim_time_ns / 1e9)
        return None

    def _enters(self, person: _Person, way: Way, sim_time_ns: int) -> bool:
        """Let a person go to another level, if there is room on the way; return whether they do."""
        return self._passages.enter(person.victim.name, way, person.victim.speed_mps * person.speed_share, sim_time_ns)

    def _behind(self, person: _Person, leader: Point, sim_time_ns: int, grid: _Grid) -> Point | None:
        """Return the farthest place of a leader's trail that a follower sees; close behind, their own position.

        None: they follow to another level.
        """
        trail, passages = person.trail, self._passages
        if not trail or math.dist(trail[-1], leader) > _TRAIL_STEP_M:
            if trail and (way := passages.way_between(trail[-1], leader)) is not None:
                trail.append(way.start)
            trail.append(leader)
        if person.victim.name in passages:
            return None
        if math.dist(person.position, leader) <= self._tuning.follow_gap_m:
            return person.position
        here = person.position
        while len(trail) > 1 and passages.is_same_level(here, trail[1]) and grid.sees(here, trail[1]):
            del trail[0]
        way = passages.way_between(trail[0], trail[1]) if len(trail) > 1 else None
        is_at_stop = way is not None and math.dist(here, way.start) <= way.passage.radius_m
        return None if way is not None and is_at_stop and self._enters(person, way, sim_time_ns) else trail[0]

    def _arrive(self, sim_time_ns: int, bodies_m: np.ndarray, settled: Collection[str]) -> None:
        """Put those whose way ends to its end, or next to it; without room they wait."""
        radius_m = self._tuning.radius_m
        for name, person in self._persons.items():
            way = self._passages.due(name, sim_time_ns)
            if way is None:
                continue
            floor = self._grid_around(())  # heat stops nobody who comes
            others = [
                (*other.position, radius_m)
                for other_name, other in self._persons.items()
                if other_name not in settled and other_name not in self._passages
            ]
            others_m = np.array([*others, *np.column_stack([bodies_m, self._reaches_m])]).reshape(-1, 3)
            for place in places_at_end(way, person.position):
                # Not `>=`: those who are absent are NaN, and touch nobody.
                touches = np.hypot(*(others_m[:, :2] - place).T) < radius_m + others_m[:, 2]
                if floor.is_free(place) and not touches.any():
                    person.position = place
                    self._passages.leave(name)
                    del person.trail[:1]  # the stop that they left
                    break

    def _walk(
        self,
        walkers: Sequence[tuple[_Person, Point]],
        standing: Sequence[Point],
        bodies_m: np.ndarray,
        doors: DoorStates,
    ) -> None:
        radius_m = self._tuning.radius_m
        rows = np.array([(*p.position, *target, p.victim.speed_mps * p.speed_share, radius_m) for p, target in walkers])
        there = ~np.isnan(bodies_m[:, 0])
        others = np.column_stack([bodies_m[there], self._reaches_m[there]])
        if standing:
            others = np.vstack([others, [(*place, radius_m) for place in standing]])
        moved = self._crowd.step(rows, others, list(doors.closed().values()), self._step_ns / 1e9)
        for (person, _), (x, y) in zip(walkers, moved.tolist(), strict=True):
            person.position = (x, y)


class _Grid:
    """The free floor for a person's body, and paths to exits."""

    def __init__(self, building: Building, radius_m: float, doors: Doors, hot: tuple[Block, ...]) -> None:
        occupancy = building.grid(_CELL_M, doors)
        blocked = occupancy.cells != FREE
        for row, column in hot:
            rows, columns = (slice(index * _PER_BLOCK, (index + 1) * _PER_BLOCK) for index in (row, column))
            blocked[rows, columns] = True
        by_passages = portals(building.plan.levels, building.plan.passages, "people")
        self._core = _core.plan.PlanningGrid(blocked, occupancy.origin_m, _CELL_M, radius_m + _MARGIN_M, by_passages)
        self._to_exits: dict[tuple[Point, ...], np.ndarray | None] = {}

    def towards_exit(self, exits_m: tuple[Point, ...], position: Point, look_ahead_m: float) -> Point | None:
        """Return a place in sight on the shortest path to the nearest exit; None if no path is open."""
        lengths = self._lengths_m(exits_m)
        return None if lengths is None else self._core.descend(lengths, position, look_ahead_m)

    def leads_by(self, way: Way, exits_m: tuple[Point, ...]) -> bool:
        """Whether the shortest path from the beginning of a way to the nearest exit leads over it."""
        lengths = self._lengths_m(exits_m)
        if lengths is None:
            return False
        from_start_m, from_end_m = (self._core.value_at(lengths, place) for place in (way.start, way.end))
        by_way_m = max(way.equivalent_m("people"), _CELL_M) + from_end_m
        return math.isfinite(by_way_m) and by_way_m <= from_start_m + _EQUAL_M

    def is_free(self, place: Point) -> bool:
        """Whether a person has room between walls."""
        return self._core.is_free(place)

    def _lengths_m(self, exits_m: tuple[Point, ...]) -> np.ndarray | None:
        if exits_m not in self._to_exits:
            goals = [goal for place in exits_m if (goal := self._core.nearest_free(place, 1.0)) is not None]
            maps = [self._core.distance_map(goal) for goal in goals]
            self._to_exits[exits_m] = np.minimum.reduce(maps) if maps else None
        return self._to_exits[exits_m]

    def sees(self, position: Point, place: Point) -> bool:
        """Whether a person can walk to a place in a straight line."""
        start = self._core.nearest_free(position, 0.5)
        return start is not None and self._core.is_line_free(start, place)


def crowd_parameters(tuning: PeopleSection) -> _core.world.CrowdParameters:
    """Return the parameters of the model for the C++ library."""
    return _core.world.CrowdParameters(
        time_gap_s=tuning.time_gap_s,
        neighbour_strength=tuning.neighbour_strength,
        neighbour_range_m=tuning.neighbour_range_m,
        wall_strength=tuning.wall_strength,
        wall_range_m=tuning.wall_range_m,
        longest_substep_s=tuning.longest_substep_s,
    )
