"""Distances to walls on a grid, and the reach of beams, against SciPy and shapely."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from scipy.ndimage import distance_transform_edt

from robotteamsim import _core, rng

ORIGIN_M, CELL_M = (-3.0, 2.0), 0.25


def random_cells() -> np.ndarray:
    return rng.stream(1, "cells").random((40, 60)) < 0.03


def test_distances_equal_those_of_scipy() -> None:
    occupied = random_cells()
    field = _core.maps.DistanceField(occupied, ORIGIN_M, CELL_M)
    assert field.distances_m() == pytest.approx(CELL_M * distance_transform_edt(~occupied), abs=1e-5)


def test_beams_reach_as_far_as_rays_to_the_squares_of_occupied_cells() -> None:
    occupied, generator = random_cells(), rng.stream(1, "beams")
    field = _core.maps.DistanceField(occupied, ORIGIN_M, CELL_M)
    rows, columns = np.nonzero(occupied)
    x_m, y_m = ORIGIN_M[0] + columns * CELL_M, ORIGIN_M[1] + rows * CELL_M
    walls = shapely.union_all(shapely.box(x_m, y_m, x_m + CELL_M, y_m + CELL_M))
    reached = 0
    for _ in range(500):
        start = ORIGIN_M[0] + generator.uniform(0.0, 15.0), ORIGIN_M[1] + generator.uniform(0.0, 10.0)
        angle_rad = generator.uniform(-math.pi, math.pi)
        end = start[0] + 4.0 * math.cos(angle_rad), start[1] + 4.0 * math.sin(angle_rad)
        hit = shapely.LineString([start, end]).intersection(walls)
        expected_m = math.inf if hit.is_empty else shapely.Point(start).distance(hit)
        assert field.trace(start, angle_rad, 4.0) == pytest.approx(expected_m, abs=1e-6)
        reached += not hit.is_empty
    assert 100 < reached < 450
