"""People of groups, at random places, with speeds and delays from the distributions of their group."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np

from robotteamsim import rng
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.people import PeopleGroup, quantile
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.victims import Victim
from robotteamsim.world.placement import placed_robots
from robotteamsim.world.random_victims import reachable_cells_m

_Disc = tuple[float, float, float]
"""x, y and radius [m]."""


def with_drawn_people(scenario: Scenario, building: Building) -> Scenario:
    """Return a scenario whose groups of people are victims of its mission; the same if there are no groups.

    Each is at the centre of a cell of their region, uniformly drawn from those where their body has room, and from
    which an exit, or without exits a robot's start, can be reached through open doors. Nobody is in an exit, or touches
    another person who walks, or a robot.

    Random streams: ("people", name of the group).
    Raises: PlacementError: a robot has no room. ScenarioError: a group has no room.
    """
    if not scenario.people.groups:
        return scenario
    radius_m, mission = scenario.people.radius_m, scenario.mission
    robots = [robot for robot in placed_robots(scenario, building) if robot.present]
    starts = tuple(way.center for way in mission.exits) or tuple(robot.start_pose[:2] for robot in robots)
    cells_m = building.shared(reachable_cells_m, radius_m, starts, "people", through_doors=True)
    for way in mission.exits:
        cells_m = cells_m[np.hypot(*(cells_m - way.center).T) > way.radius_m]
    taken: list[_Disc] = [(*robot.start_pose[:2], robot.reach_m) for robot in robots]
    taken += [(*victim.position, radius_m) for victim in mission.victims if victim.flees or victim.can_walk]
    drawn: list[Victim] = []
    for index, group in enumerate(scenario.people.groups):
        generator = rng.stream(scenario.run.seed, "people", group.name)
        places = _places_m(group, generator.permutation(_within(group, cells_m)), taken, radius_m)
        if len(places) < group.count:
            key = f"people.groups.{index}.count"
            line = f"{key}: {group.count} people, but there is room for {len(places)} in their region"
            raise ScenarioError(scenario.origin.line(line, key))
        shares = generator.random((group.count, 2)).tolist()
        for name, place, (of_speed, of_delay) in zip(group.names, places, shares, strict=True):
            taken.append((*place, radius_m))
            drawn.append(_person(group, name, place, of_speed, of_delay))
    return scenario.model_copy(
        update={
            "mission": mission.model_copy(update={"victims": (*mission.victims, *drawn)}),
            "people": scenario.people.model_copy(update={"groups": ()}),
        }
    )


def _person(group: PeopleGroup, name: str, place: Point, of_speed: float, of_delay: float) -> Victim:
    return Victim(
        name=name,
        position=place,
        speed_mps=quantile(group.speed_mps, of_speed),
        flees=group.flees,
        flees_after_s=quantile(group.flees_after_s, of_delay),
        can_walk=group.can_walk,
        calling=group.calling,
    )


def _within(group: PeopleGroup, cells_m: np.ndarray) -> np.ndarray:
    """Return the centres of the cells in a group's region, shape (n, 2)."""
    return cells_m if group.region is None else cells_m[group.region.contain(cells_m)]


def _places_m(group: PeopleGroup, cells_m: np.ndarray, taken: Sequence[_Disc], radius_m: float) -> list[Point]:
    """Return the first places, one for each person if there is room, that touch no disc and not each other."""
    size_m = 2.0 * max(radius_m, max((reach for *_, reach in taken), default=0.0))
    by_bin: dict[tuple[int, int], list[_Disc]] = defaultdict(list)

    def near(x: float, y: float) -> Iterator[_Disc]:
        column, row = math.floor(x / size_m), math.floor(y / size_m)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                yield from by_bin.get((column + i, row + j), ())

    def add(disc: _Disc) -> None:
        by_bin[math.floor(disc[0] / size_m), math.floor(disc[1] / size_m)].append(disc)

    for disc in taken:
        add(disc)
    places: list[Point] = []
    for x, y in cells_m.round(3).tolist():
        if len(places) == group.count:
            break
        if all(math.hypot(x - other_x, y - other_y) >= radius_m + reach_m for other_x, other_y, reach_m in near(x, y)):
            places.append((x, y))
            add((x, y, radius_m))
    return places
