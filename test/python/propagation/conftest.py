"""Small floor plans for the tests of this floor."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall


@pytest.fixture
def make_plan() -> Callable[..., FloorPlan]:
    """Make a floor of 20 x 20 m."""

    def make(walls: tuple[Wall, ...] = (), blocks: tuple[Block, ...] = (), doors: tuple[Door, ...] = ()) -> FloorPlan:
        return FloorPlan(name="floor", bounds=Bounds(max=(20.0, 20.0)), walls=walls, blocks=blocks, doors=doors)

    return make


@pytest.fixture
def flat(make_plan: Callable[..., FloorPlan]) -> FloorPlan:
    """Return a floor with diagonal and crossing walls of all classes, a block, a pillar and two doors."""
    return make_plan(
        walls=(
            Wall(name="west", start=(4.0, 0.5), end=(4.0, 19.5), thickness_m=0.2),
            Wall(name="middle", start=(1.0, 12.0), end=(19.0, 12.0), thickness_m=0.4),
            Wall(name="diagonal", start=(6.0, 1.0), end=(16.0, 9.0), thickness_m=0.5),
            Wall(name="thick", start=(17.0, 1.0), end=(12.0, 11.0), thickness_m=0.7),
            Wall(name="left_of_gap", start=(6.0, 15.0), end=(9.0, 15.0), thickness_m=0.1),
            Wall(name="right_of_gap", start=(10.0, 15.0), end=(14.0, 15.0), thickness_m=0.1),
        ),
        blocks=(
            Block(name="core", polygon=((14.0, 14.0), (18.0, 15.0), (17.0, 18.5))),
            Block(name="pillar", kind="pillar", polygon=((8.0, 7.0), (8.6, 7.0), (8.6, 7.6), (8.0, 7.6))),
        ),
        doors=(
            Door(name="glass", start=(9.0, 15.0), end=(10.0, 15.0)),
            Door(name="fire", start=(4.0, 19.5), end=(5.0, 20.0), kind="fireproof", closed=True),
        ),
    )
