"""Victims who walk: hand-calculated positions, random walks that cross no wall."""

from __future__ import annotations

import itertools
import math

import pytest
import shapely

from robotteamsim.scenario.plan import solids
from robotteamsim.scenario.sections import Mission, Run, Victim
from robotteamsim.scenario.victims import Region
from robotteamsim.testing.contract.two_rooms import two_rooms
from robotteamsim.world.walking import Walk, Walkers

PLAN = two_rooms(closed=True)
EVERYWHERE = Region(polygon=((0.0, 0.0), (12.0, 0.0), (12.0, 6.0), (0.0, 6.0)))


def ann(**keys: object) -> Victim:
    return Victim(name="ann", position=(1.0, 1.0), **keys)


def places(victim: Victim, *times_s: float, seed: int = 1) -> list[tuple[float, float]]:
    walk = Walk(PLAN, victim, seed)
    return [walk.position_m(time_s) for time_s in times_s]


def test_victim_walks_along_the_path_at_their_speed_and_stays_at_its_end():
    # 4 m east in 8 s, then 2 m north in 4 s.
    victim = ann(path=((5.0, 1.0), (5.0, 3.0)), speed_mps=0.5)
    assert places(victim, 0.0, 2.0, 8.0, 9.0, 12.0, 1e6) == [
        (1.0, 1.0),
        (2.0, 1.0),
        (5.0, 1.0),
        (5.0, 1.5),
        (5.0, 3.0),
        (5.0, 3.0),
    ]


def test_loop_leads_from_the_last_place_to_the_first_one():
    # To (3, 1) in 2 s; from there to (3, 4), 3 s, and back, 3 s.
    victim = ann(path=((3.0, 1.0), (3.0, 4.0)), loop=True, speed_mps=1.0)
    assert places(victim, 2.0, 5.0, 6.0, 8.0, 602.0) == [(3.0, 1.0), (3.0, 4.0), (3.0, 3.0), (3.0, 1.0), (3.0, 1.0)]


def test_two_equal_places_on_a_path_cost_no_time():
    assert places(ann(path=((1.0, 1.0), (3.0, 1.0), (3.0, 1.0), (3.0, 3.0)), speed_mps=1.0), 3.0) == [(3.0, 2.0)]


def test_position_depends_on_time_and_seed_but_not_on_what_was_asked_before():
    victim = ann(wander=EVERYWHERE, speed_mps=1.0)
    times_s = [0.0, 0.5, 7.3, 60.0, 599.0]
    assert places(victim, *times_s) == places(victim, *reversed(times_s))[::-1]
    assert places(victim, *times_s) != places(victim, *times_s, seed=2)
    assert places(victim, *times_s)[1:] != places(victim.model_copy(update={"name": "bob"}), *times_s)[1:]


@pytest.mark.slow
@pytest.mark.parametrize(
    "region",
    [EVERYWHERE, Region(center=(3.0, 2.0), radius_m=2.5), Region(polygon=((0.5, 0.5), (3.0, 0.5), (0.5, 3.0)))],
)
def test_random_walk_stays_in_its_region_crosses_no_wall_and_keeps_its_speed(region):
    steps = [0.1 * i for i in range(6000)]
    way = places(ann(wander=region, speed_mps=0.8), *steps)
    walls = shapely.union_all([solid.polygon for solid in solids(PLAN) if solid.kind == "wall"])
    assert not shapely.LineString(way).intersects(walls)
    assert all(region.contains(place) for place in way)
    lengths_m = [math.dist(a, b) for a, b in itertools.pairwise(way)]
    # A step around a corner is shorter in a straight line.
    assert max(lengths_m) == pytest.approx(0.08)
    assert sum(length_m > 0.0799 for length_m in lengths_m) > 5000


def test_random_walk_goes_through_doors():
    xs = [x for x, _ in places(ann(wander=EVERYWHERE, speed_mps=2.0), *range(1200))]
    assert min(xs) < 5.0
    assert max(xs) > 7.0


def test_walkers_report_positions_once_per_update_at_the_time_of_the_update(hall_scenario):
    mission = Mission(victims=(ann(path=((5.0, 1.0),), speed_mps=1.0), Victim(name="bob", position=(12.0, 7.0))))
    scenario = hall_scenario(mission=mission, run=Run(step_s=0.3))
    walkers = Walkers(scenario)
    due = [walkers.positions_due(step * 300_000_000) for step in range(1, 8)]
    # Stamps 0.3 .. 2.1 s: 1.2 s is the first at or after 1 s, 2.1 s the first at or after 2 s.
    assert due == [{}, {}, {}, {"ann": (2.0, 1.0)}, {}, {}, {"ann": (3.0, 1.0)}]
    walkers.stop("ann")
    assert walkers.positions_due(3_000_000_000) == {}
