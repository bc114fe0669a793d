"""Polygons that are rectangles."""

import math

import pytest

from robotteamsim.scenario.plan import rectangle_of


def test_outline_of_a_turned_square_equals_the_hand_calculation():
    found = rectangle_of(((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)))
    side_m = math.sqrt(2.0)
    assert found is not None
    assert (found.x, found.y, found.yaw) == pytest.approx((0.0, 0.0, math.pi / 4.0))
    assert (found.length_m, found.width_m) == pytest.approx((side_m, side_m))


@pytest.mark.parametrize(
    "corners",
    [
        ((0.0, 0.0), (2.0, 0.0), (3.0, 1.0), (1.0, 1.0)),
        ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.1)),
        ((0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 0.0)),
        ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)),
    ],
    ids=["parallelogram", "no parallel sides", "flat", "triangle"],
)
def test_other_polygons_are_none(corners):
    assert rectangle_of(corners) is None
