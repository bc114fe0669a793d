"""Walls that cross obliquely: their outline on whole millimetres, and rays along it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely

from robotteamsim.propagation import RadioField
from robotteamsim.propagation.faces import radio_faces
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.sections import Radio

THICK = ((14.861, 1.969), (14.775, 2.703), (14.079, 2.620), (14.166, 1.887))
LONG = ((14.010, 2.142), (18.349, 2.656), (18.290, 3.152), (13.951, 2.639))
"""Two walls that cross, of one class (5.7 dB)."""


def plan_of(*polygons: object, thickness_m: float | None = 0.5) -> FloorPlan:
    """Return a plan of walls of one class, which are one wall; without a thickness, of blocks, each of its own."""
    blocks = tuple(Block(name=f"b{i}", polygon=polygon, thickness_m=thickness_m) for i, polygon in enumerate(polygons))
    return FloorPlan(name="oblique", bounds=Bounds(min=(-30.0, -30.0), max=(30.0, 30.0)), blocks=blocks)


def turned(points: object, degrees: int) -> tuple[tuple[float, float], ...]:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return tuple((cos * x - sin * y, sin * x + cos * y) for x, y in points)


def strip(centre_m: np.ndarray, angle_rad: float, length_m: float, width_m: float) -> np.ndarray:
    """Return the corners of a rectangle, counter-clockwise, in whole millimetres."""
    along = np.array([math.cos(angle_rad), math.sin(angle_rad)]) * length_m / 2.0
    across = np.array([-math.sin(angle_rad), math.cos(angle_rad)]) * width_m / 2.0
    corners_m = [centre_m + i * along + j * across for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.rint(1000.0 * np.array(corners_m)).astype(int)


def oblique_walls(seed: int, count: int = 6) -> list[np.ndarray]:
    """Return rectangles at random places and angles."""
    generator = np.random.default_rng(seed)
    return [
        strip(
            generator.uniform(6.0, 14.0, 2),
            generator.uniform(0.0, math.pi),
            generator.uniform(2.0, 8.0),
            generator.uniform(0.1, 0.9),
        )
        for _ in range(count)
    ]


def is_inside(wall: np.ndarray, point: np.ndarray) -> bool:
    along, offset = np.roll(wall, -1, axis=0) - wall, point - wall
    return bool(np.all(along[:, 0] * offset[:, 1] - along[:, 1] * offset[:, 0] > 0))


@pytest.mark.parametrize("degrees", range(0, 360, 5))
def test_ray_along_an_oblique_face_through_a_crossing_pays_that_wall_once_or_nothing(degrees):
    # From the corner of the long wall, along its lower face, to 2 mm inside: half of 5.7 dB, or nothing if the corner
    # counts as inside. The wall that it crosses is of the same class and costs nothing.
    core = radio_faces(plan_of(turned(THICK, degrees), turned(LONG, degrees)), Radio()).core()
    start, end = turned(((14.010, 2.142), (15.750, 2.350)), degrees)
    assert core.weight_between(start, end) == core.weight_between(end, start)
    assert core.weight_between(start, end) in ((57,) if degrees == 0 else (0, 57))


@pytest.mark.slow
def test_ray_inside_a_wall_pays_nothing_however_near_to_its_face():
    num_rays = 0
    for seed in range(40):
        walls = oblique_walls(seed)
        core = radio_faces(plan_of(*((wall / 1000.0).tolist() for wall in walls)), Radio()).core()
        generator = np.random.default_rng(seed)
        for wall, side in itertools.product(walls, range(4)):
            start, end = wall[side], wall[(side + 1) % 4]
            inwards = np.array([start[1] - end[1], end[0] - start[0]]) / math.dist(start, end)
            for shares in generator.uniform(0.0, 1.0, (8, 2)):
                depths_mm = generator.uniform(0.3, 2.5, 2)
                ray = [np.rint(start + s * (end - start) + d * inwards) for s, d in zip(shares, depths_mm, strict=True)]
                if all(is_inside(wall, point) for point in ray):
                    num_rays += 1
                    assert core.weight_between(*(tuple(point / 1000.0) for point in ray)) == 0
    assert num_rays > 5000


def test_outline_of_crossing_walls_contains_them_and_exceeds_them_by_millimetres():
    for seed in range(40):
        walls = oblique_walls(seed)
        faces = radio_faces(plan_of(*((wall / 1000.0).tolist() for wall in walls)), Radio())
        rings = shapely.polygonize(shapely.linestrings(faces.ends_mm.reshape(-1, 2, 2)))
        exact = shapely.union_all([shapely.Polygon(wall) for wall in walls])
        outline = shapely.union_all([ring for ring in rings.geoms if exact.intersects(ring.representative_point())])
        assert exact.difference(outline).area < 1e-3
        assert shapely.hausdorff_distance(outline, exact) < 5.0


def test_map_of_oblique_walls_equals_one_ray_per_cell():
    plan = plan_of(*((wall / 1000.0).tolist() for wall in oblique_walls(3, 12)))
    field = RadioField(plan, Radio())
    transmitter = (10.1, 9.9)
    drawn = field.rssi_map_dbm(transmitter, 0.5)
    for (row, column), value in np.ndenumerate(drawn.values):
        cell = (drawn.origin_m[0] + (column + 0.5) * 0.5, drawn.origin_m[1] + (row + 0.5) * 0.5)
        assert value == pytest.approx(Radio().tx_power_dbm - field.path_loss_db(transmitter, cell), abs=1e-4)


@pytest.mark.slow
def test_ray_outside_along_a_thick_wall_pays_each_thin_wall_at_most_as_much_as_the_thick_one():
    generator = np.random.default_rng(5)
    for _ in range(60):
        angle_rad, turn_rad = generator.uniform(0.0, math.pi), generator.uniform(0.5, 2.6)
        along = np.array([math.cos(angle_rad), math.sin(angle_rad)])
        thick = strip(np.zeros(2), angle_rad, 12.0, 0.7)  # 12.4 dB
        thin = [strip(place_m * along, angle_rad + turn_rad, 4.0, 0.15) for place_m in (-3.0, 0.0, 3.0)]  # 3.8 dB
        elements = ((wall / 1000.0).tolist() for wall in (thick, *thin))
        core = radio_faces(plan_of(*elements, thickness_m=None), Radio()).core()
        start, end = thick[:2]
        outwards = np.array([end[1] - start[1], start[0] - end[0]]) / math.dist(start, end)
        for depths_mm in generator.uniform(1.5, 4.0, (10, 2)):
            ray = [np.rint(start + depths_mm[0] * outwards), np.rint(end + depths_mm[1] * outwards)]
            weight = core.weight_between(*(tuple(point / 1000.0) for point in ray))
            assert 3 * 76 <= weight <= 3 * 248
