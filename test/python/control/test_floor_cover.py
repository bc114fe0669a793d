"""What a robot knows to be covered of a floor."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.control.cover.floor_cover import FloorCover
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall

HALL = FloorPlan(name="hall", bounds=Bounds(max=(20.0, 10.0)))
ROOMS = FloorPlan(
    name="rooms",
    bounds=Bounds(max=(20.0, 10.0)),
    walls=(
        Wall(name="low", start=(10.0, 0.0), end=(10.0, 4.0)),
        Wall(name="high", start=(10.0, 6.0), end=(10.0, 10.0)),
        Wall(name="left", start=(16.0, 0.0), end=(16.0, 10.0)),
    ),
)


def _cover(plan: FloorPlan = HALL, radius_m: float = 2.5) -> FloorCover:
    return FloorCover(Building(plan), 0.2, (3.0, 5.0), radius_m)


def test_nothing_is_covered_before_the_first_look():
    assert _cover().share == 0.0


def test_a_look_covers_the_cells_whose_middle_is_within_the_radius():
    cover = _cover()
    cover.look((5.0, 5.0))
    middles = np.arange(20) + 0.5
    within = np.hypot(middles[None, :] - 5.0, middles[:10, None] - 5.0) <= 2.5
    assert cover.share == np.count_nonzero(within) / 200
    assert cover.is_covered((5.4, 6.9))
    assert not cover.is_covered((7.7, 5.5))


def test_a_look_does_not_go_through_walls():
    cover = _cover(ROOMS)
    cover.look((9.0, 2.0))
    assert cover.is_covered((8.5, 2.5))
    assert not cover.is_covered((10.5, 2.5))


def test_rooms_that_cannot_be_entered_do_not_count():
    cover = _cover(ROOMS)
    for x in np.arange(0.5, 16.0, 1.0):
        for y in np.arange(0.5, 10.0, 1.0):
            cover.look((float(x), float(y)))
    assert cover.share == 1.0
    assert cover.best_place((3.0, 5.0), [], 4.0) is None


def test_cells_that_others_covered_are_merged():
    first, second = _cover(), _cover()
    first.look((5.0, 5.0))
    second.look((15.0, 5.0))
    alone = second.share
    assert second.merge(first.to_hex())
    assert second.share == pytest.approx(alone + first.share)
    assert second.is_covered((5.0, 5.0))
    assert second.is_covered((15.0, 5.0))


@pytest.mark.parametrize("text", ["", "ff", "no hex", "f" * 51])
def test_map_of_another_floor_is_not_merged(text):
    cover = _cover()
    assert not cover.merge(text)
    assert cover.share == 0.0


def test_best_place_is_uncovered_and_near():
    cover = _cover()
    cover.look((3.0, 5.0))
    place = cover.best_place((3.0, 5.0), [], 4.0)
    assert not cover.is_covered(place)
    assert np.hypot(place[0] - 3.0, place[1] - 5.0) < 6.0


def test_best_place_is_not_hot_and_does_not_look_at_hot_cells():
    cover, start = _cover(), (3.0, 5.0)
    hot = {(row, column) for row in range(10) for column in range(12)}
    outside = {(0, 20), (10, 0), (99, 99)}
    assert cover.best_place(start, [], 4.0, hot=hot | outside)[0] > 12.0
    cold = {(0, 19)}
    everything = {(row, column) for row in range(10) for column in range(20)}
    assert cover.best_place(start, [], 4.0, hot=everything - cold) == pytest.approx((19.5, 0.5), abs=0.4)
    assert cover.best_place(start, [], 4.0, hot=everything) is None


def test_best_place_keeps_out_of_discs_and_within_cells():
    cover = _cover()
    assert cover.best_place((3.0, 5.0), [((3.0, 5.0), 8.0)], 4.0)[0] > 9.0
    within = np.zeros((10, 20), dtype=bool)
    within[2, 17] = True
    assert cover.best_place((3.0, 5.0), [], 4.0, within) == pytest.approx((17.5, 2.5), abs=0.1)
    assert cover.best_place((3.0, 5.0), [], 4.0, np.zeros((10, 20), dtype=bool)) is None
