"""The faces that a floor plan turns into."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.propagation.faces import Faces, radio_faces, thickness_faces, voice_faces
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import solids
from robotteamsim.scenario.sections import Radio


def _rows(faces: Faces) -> set[tuple[int, ...]]:
    """Return (x1, y1, x2, y2, weight) of every face, the smaller end first."""
    rows = set()
    for (x1, y1, x2, y2), weight in zip(faces.ends_mm.tolist(), faces.weights.tolist(), strict=True):
        rows.add((*min((x1, y1), (x2, y2)), *max((x1, y1), (x2, y2)), weight))
    return rows


def test_wall_has_four_faces_of_half_its_loss(make_plan):
    faces = radio_faces(make_plan(walls=(Wall(name="a", start=(1.0, 2.0), end=(5.0, 2.0)),)), Radio())
    assert _rows(faces) == {
        (1000, 1900, 5000, 1900, 38),
        (1000, 2100, 5000, 2100, 38),
        (1000, 1900, 1000, 2100, 38),
        (5000, 1900, 5000, 2100, 38),
    }


@pytest.mark.parametrize(
    ("thickness_m", "loss_db"),
    [
        (0.1, 3.8),
        (0.2, 3.8),
        (0.2004, 3.8),
        (0.201, 3.9),
        (0.4, 3.9),
        (0.401, 5.7),
        (0.6, 5.7),
        (0.601, 12.4),
        (0.8, 12.4),
    ],
)
def test_class_of_a_wall_is_its_thickness_in_whole_millimetres(make_plan, thickness_m, loss_db):
    wall = Wall(name="a", start=(1.0, 2.0), end=(5.0, 4.0), thickness_m=thickness_m)
    assert set(radio_faces(make_plan(walls=(wall,)), Radio()).weights) == {round(loss_db * 10)}


@pytest.mark.parametrize(
    ("polygon", "loss_db"),
    [
        (((1.0, 1.0), (9.0, 1.0), (9.0, 1.3), (1.0, 1.3)), 3.9),
        (((1.0, 1.0), (1.3, 1.3), (1.0, 1.6), (0.7, 1.3)), 5.7),  # a square of 0.42 m on its corner
        (((1.0, 1.0), (9.0, 1.0), (9.0, 3.0), (1.0, 3.0)), 12.4),  # over 80 cm
    ],
)
def test_class_of_a_block_is_its_least_width(make_plan, polygon, loss_db):
    plan = make_plan(blocks=(Block(name="a", polygon=polygon),))
    assert set(radio_faces(plan, Radio()).weights) == {round(loss_db * 10)}


@pytest.mark.slow
def test_class_of_a_right_triangle_is_that_of_its_height_at_every_angle(make_plan):
    # Its height over the longest side is 0.9 * 0.62 / hypot(0.9, 0.62) = 0.511 m, which costs 5.7 dB.
    for degrees in range(360):
        triangle = shapely.affinity.rotate(shapely.Polygon([(5.0, 5.0), (5.9, 5.0), (5.0, 5.62)]), degrees)
        block = Block(name="a", polygon=tuple(triangle.exterior.coords[:-1]))
        assert set(radio_faces(make_plan(blocks=(block,)), Radio()).weights) == {57}


@given(st.lists(st.tuples(st.floats(1.0, 9.0), st.floats(1.0, 9.0)), min_size=3, max_size=8))
@settings(max_examples=50)
def test_width_of_a_block_is_the_least_extent_over_all_rotations(points):
    hull = shapely.convex_hull(shapely.MultiPoint(points))
    assume(hull.area > 0.01)
    corners_m = shapely.get_coordinates(hull)[:-1]
    angles_rad = np.linspace(0.0, np.pi, 20001)
    extents_m = np.ptp(corners_m @ np.array([np.cos(angles_rad), np.sin(angles_rad)]), axis=0)
    plan = FloorPlan(name="a", bounds=Bounds(max=(10.0, 10.0)), blocks=(Block(name="a", polygon=corners_m.tolist()),))
    (width_mm,) = set(thickness_faces(plan).weights.tolist())
    # The angles are 0.16 mrad apart, and the width is rounded to whole millimetres.
    assert width_mm / 1000.0 == pytest.approx(extents_m.min(), abs=0.0005 + 12.0 * 0.00016)


def test_stated_thickness_of_a_block_takes_the_place_of_its_width(make_plan):
    polygon = ((1.0, 1.0), (9.0, 1.0), (9.0, 1.3), (1.0, 1.3))
    for thickness_m, loss_db in ((0.15, 3.8), (0.5, 5.7), (1.0, 12.4)):
        block = Block(name="a", polygon=polygon, thickness_m=thickness_m)
        assert set(radio_faces(make_plan(blocks=(block,)), Radio()).weights) == {round(loss_db * 10)}


def test_faces_that_abutting_walls_share_vanish(make_plan):
    walls = (Wall(name="a", start=(1.0, 2.0), end=(5.0, 2.0)), Wall(name="b", start=(5.0, 2.0), end=(8.0, 2.0)))
    faces = radio_faces(make_plan(walls=walls), Radio())
    assert not any(x1 == x2 == 5000 for x1, _, x2, _ in faces.ends_mm.tolist())
    assert faces.core().weight_between((0.5, 2.0), (9.0, 2.0)) == 76


def test_each_stretch_of_abutting_walls_keeps_its_own_loss(make_plan):
    walls = (
        Wall(name="a", start=(1.0, 2.0), end=(5.0, 2.0)),
        Wall(name="b", start=(5.0, 2.0), end=(8.0, 2.0), material="glass"),
    )
    faces = radio_faces(make_plan(walls=walls), Radio(materials={"glass": 2.0})).core()
    assert faces.weight_between((3.0, 1.0), (3.0, 3.0)) == 76
    assert faces.weight_between((6.0, 1.0), (6.0, 3.0)) == 40


def test_edges_inside_the_union_are_not_faces(make_plan):
    walls = (Wall(name="a", start=(2.0, 5.0), end=(8.0, 5.0)), Wall(name="b", start=(5.0, 2.0), end=(5.0, 8.0)))
    faces = radio_faces(make_plan(walls=walls), Radio())
    assert len(faces.weights) == 12  # a cross
    assert faces.core().weight_between((1.0, 5.0), (9.0, 5.0)) == 76


def test_where_outlines_coincide_the_highest_loss_counts(make_plan):
    light = Wall(name="light", start=(1.0, 2.0), end=(6.0, 2.0), material="glass")
    heavy = Wall(name="heavy", start=(4.0, 2.0), end=(9.0, 2.0))
    for walls in ((light, heavy), (heavy, light)):
        faces = radio_faces(make_plan(walls=walls), Radio(materials={"glass": 2.0})).core()
        assert faces.weight_between((2.0, 1.0), (2.0, 3.0)) == 40
        assert faces.weight_between((5.0, 1.0), (5.0, 3.0)) == 76  # both
        assert faces.weight_between((8.0, 1.0), (8.0, 3.0)) == 76


def test_ray_through_overlapping_walls_loses_half_of_each_crossed_outline(make_plan):
    walls = (
        Wall(name="thin", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.2),  # 3.8 dB
        Wall(name="thick", start=(2.0, 5.2), end=(8.0, 5.2), thickness_m=0.7),  # 12.4 dB, from 4.85 to 5.55
    )
    overlapping = (walls[0].model_copy(update={"start": (2.0, 4.8), "end": (8.0, 4.8)}), walls[1])
    for order in (overlapping, overlapping[::-1]):
        faces = radio_faces(make_plan(walls=order), Radio()).core()
        assert faces.weight_between((5.0, 4.0), (5.0, 6.0)) == 38 + 124  # in by the thin, out of the thick
        assert faces.weight_between((5.0, 6.0), (5.0, 4.0)) == 38 + 124


def test_solid_wholly_inside_another_adds_nothing(make_plan):
    outer = Wall(name="outer", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.7, material="glass")
    inner = Wall(name="inner", start=(3.0, 5.0), end=(7.0, 5.0), thickness_m=0.5)
    radio = Radio(materials={"glass": 2.0})
    assert _rows(radio_faces(make_plan(walls=(inner, outer)), radio)) == _rows(
        radio_faces(make_plan(walls=(outer,)), radio)
    )


def test_crossing_walls_of_two_classes_cost_their_own_loss_next_to_the_crossing(make_plan):
    walls = (
        Wall(name="thin", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.2),
        Wall(name="thick", start=(5.0, 2.0), end=(5.0, 8.0), thickness_m=0.7),
    )
    faces = radio_faces(make_plan(walls=walls), Radio()).core()
    assert faces.weight_between((3.0, 4.0), (3.0, 6.0)) == 2 * 38
    assert faces.weight_between((4.0, 7.0), (6.0, 7.0)) == 2 * 124
    assert faces.weight_between((1.0, 5.0), (9.0, 5.0)) == 2 * 38  # along the thin one, through the crossing
    assert faces.weight_between((4.4, 5.6), (5.0, 5.0)) == 124  # by the thick one into the crossing


@pytest.mark.parametrize(
    "elements",
    [
        {"walls": (Wall(name="a", start=(5.0, 1.0), end=(5.0, 1.0001)),)},
        {"walls": (Wall(name="a", start=(5.0, 1.0), end=(5.0, 9.0), thickness_m=0.0001),)},
        {"blocks": (Block(name="a", polygon=((1.0, 1.0), (9.0, 1.0), (9.0, 1.0004))),)},
    ],
)
def test_solid_that_whole_millimetres_leave_without_area_fades_nothing(make_plan, elements):
    assert len(radio_faces(make_plan(**elements), Radio()).weights) == 0


def test_duplicate_corner_changes_nothing(make_plan):
    corners = ((1.0, 1.0), (3.0, 1.0), (3.0, 2.0), (1.0, 2.0))
    once, twice = (
        make_plan(blocks=(Block(name="a", polygon=polygon),)) for polygon in (corners, (*corners, corners[0]))
    )
    assert _rows(radio_faces(once, Radio())) == _rows(radio_faces(twice, Radio()))


def test_crossings_of_diagonal_walls_are_whole_millimetres_and_rings_stay_closed(flat):
    faces = radio_faces(flat, Radio())
    assert faces.ends_mm.dtype == np.int64
    ends, counts = np.unique(faces.ends_mm[:-2].reshape(-1, 2), axis=0, return_counts=True)  # without the doors
    assert len(ends) > 30
    assert np.all(counts % 2 == 0)


def test_pillars_fade_the_radio_unless_switched_off(flat):
    through = ((8.3, 6.5), (8.3, 8.0))
    assert radio_faces(flat, Radio()).core().weight_between(*through) == 2 * 57
    assert radio_faces(flat, Radio(pillars=False)).core().weight_between(*through) == 0
    assert voice_faces(flat).core().weight_between(*through) == 2


def test_material_takes_the_place_of_the_class(make_plan):
    wall = Wall(name="a", start=(1.0, 2.0), end=(5.0, 2.0), thickness_m=0.8, material="gypsum")
    assert set(radio_faces(make_plan(walls=(wall,)), Radio(materials={"gypsum": 1.3})).weights) == {13}


def test_unknown_material_is_named_with_its_wall(make_plan):
    plan = make_plan(walls=(Wall(name="a", start=(1.0, 2.0), end=(5.0, 2.0), material="glas"),))
    message = r"^floor: a.material: 'glas' is not in radio.materials \(glass, brick\)$"
    with pytest.raises(ScenarioError, match=message):
        radio_faces(plan, Radio(materials={"glass": 2.0, "brick": 5.0}))


def test_doors_are_their_centre_segments_at_full_weight(make_plan):
    doors = (
        Door(name="d", start=(1.0, 1.0), end=(2.0, 1.0), closed=True),
        Door(name="f", start=(3.0, 1.0), end=(4.0, 1.0), kind="fireproof"),
    )
    faces = radio_faces(make_plan(doors=doors), Radio())
    assert _rows(faces) == {(1000, 1000, 2000, 1000, 28), (3000, 1000, 4000, 1000, 204)}
    assert faces.doors == {"d": True, "f": False}
    core = faces.core()
    assert core.weight_between((1.5, 0.0), (1.5, 2.0)) == 28
    assert core.weight_between((3.5, 0.0), (3.5, 2.0)) == 0
    assert voice_faces(make_plan(doors=doors)).core().weight_between((1.5, 0.0), (1.5, 2.0)) == 2


def test_unknown_door_is_rejected(flat):
    with pytest.raises(ValueError, match=r"^unknown door 'fier'; known: glass, fire$"):
        radio_faces(flat, Radio()).door_face("fier")


def test_empty_plan_has_no_faces(make_plan):
    faces = radio_faces(make_plan(), Radio())
    assert faces.ends_mm.shape == (0, 4)
    assert faces.core().weight_between((1.0, 1.0), (19.0, 19.0)) == 0


_COORDINATE = st.integers(10, 190).map(lambda decimetres: decimetres / 10.0)


@st.composite
def _walls(draw) -> tuple[Wall, ...]:
    walls = []
    for i in range(draw(st.integers(1, 8))):
        start, end = draw(st.tuples(_COORDINATE, _COORDINATE)), draw(st.tuples(_COORDINATE, _COORDINATE))
        if start != end:
            thickness_m = draw(st.sampled_from([0.1, 0.3, 0.5, 0.7]))
            walls.append(Wall(name=f"wall_{i}", start=start, end=end, thickness_m=thickness_m))
    return tuple(walls)


@pytest.mark.slow
@settings(max_examples=60)
@given(walls=_walls(), points=st.lists(st.tuples(_COORDINATE, _COORDINATE), min_size=2, max_size=8))
def test_ray_between_free_points_counts_whole_walls(walls, points):
    plan = FloorPlan(name="random", bounds=Bounds(max=(20.0, 20.0)), walls=walls)
    faces = voice_faces(plan).core()
    union = shapely.union_all([solid.polygon for solid in solids(plan)])
    free = [point for point in points if shapely.distance(union, shapely.Point(point)) > 0.005]
    for a in free:
        for b in free:
            assert faces.weight_between(a, b) % 2 == 0


@pytest.mark.parametrize("quarter_turns", range(4))
def test_positions_and_corners_at_half_a_millimetre_are_decided_equally_under_quarter_turns(make_plan, quarter_turns):
    # 8.0255 m is 8026 mm, on the face of the wall from 8026 to 8226 mm, in every orientation.
    def turned(x: float, y: float) -> tuple[float, float]:
        for _ in range(quarter_turns):
            x, y = -y, x
        return x, y

    corners = ((8.0255, 2.0005), (8.2255, 2.0005), (8.2255, 4.0005), (8.0255, 4.0005))
    bounds = Bounds(min=(-10.0, -10.0), max=(10.0, 10.0))
    block = Block(name="a", polygon=tuple(turned(*corner) for corner in corners))
    faces = radio_faces(FloorPlan(name="a", bounds=bounds, blocks=(block,)), Radio())
    expected_mm = {turned(x, y) for x, y in ((8026, 2001), (8226, 2001), (8226, 4001), (8026, 4001))}
    assert {tuple(end) for end in faces.ends_mm.reshape(-1, 2).tolist()} == expected_mm
    core = faces.core()
    # A ray that ends a millimetre in front of the face pays nothing, one that ends behind it half of the wall.
    assert core.weight_between(turned(7.0, 3.0), turned(8.0245, 3.0)) == 0
    assert core.weight_between(turned(7.0, 3.0), turned(8.0265, 3.0)) == 38
