"""A mission that is not needed any more gives its memory back at once."""

from __future__ import annotations

import gc
import weakref

import pytest

from robotteamsim.scenario import load, scenario_names
from robotteamsim.simulation import Simulation


@pytest.mark.slow
@pytest.mark.parametrize("name", scenario_names())
def test_no_circle_of_references_keeps_a_mission(name):
    gc.disable()  # it would break up circles at some later time
    try:
        # The thread by which pytest's workers talk leaves circles, too, but not each time.
        assert min(_left_by(name) for _ in range(3)) == 0
    finally:
        gc.enable()


def _left_by(name):
    """Return how many objects in circles a mission leaves."""
    mission = Simulation(load(name))
    mission.mission.start()
    for _ in range(3):
        mission.step()
    gc.collect()
    weak = weakref.ref(mission)
    del mission
    assert weak() is None
    return gc.collect()
