from __future__ import annotations

import math

import pytest

from robotteamsim.simulation.figures import TeamFigures


def test_distance_contact_and_exclusion_are_added_up_per_robot():
    figures = TeamFigures(2, step_s=0.1)
    for x in (0.0, 3.0, 3.0):
        figures.update([(x, 0.0), (0.0, x)], [x > 0.0, False], [False, True], running=True)
    first, second = figures.result()
    assert (first.distance_m, second.distance_m) == (3.0, 3.0)
    assert (first.contact_s, second.contact_s) == (pytest.approx(0.2), 0.0)
    assert (first.excluded_s, second.excluded_s) == (0.0, pytest.approx(0.3))


def test_longest_stay_is_the_longest_time_within_half_a_metre_while_the_mission_runs():
    figures = TeamFigures(1, step_s=1.0)
    walk = [0.0, 0.3, 0.4, 1.0, 1.2, 2.0]  # three steps near 0, two near 1, one at 2
    for x in walk:
        figures.update([(x, 0.0)], [False], [False], running=True)
    for _ in range(10):
        figures.update([(2.0, 0.0)], [False], [False], running=False)
    assert figures.result()[0].longest_stay_s == 3.0


def test_robot_that_comes_elsewhere_has_no_way_between():
    figures = TeamFigures(1, step_s=1.0)
    for x in (0.0, 3.0, math.nan, 10.0, 11.0):
        figures.update([(x, 0.0 * x)], [False], [False], running=True)
    assert figures.result()[0].distance_m == 4.0
