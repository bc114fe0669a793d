"""The faces that a floor plan turns into."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.propagation.faces import Faces, radio_faces, thickness_faces, voice_faces
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import solids, wall_corners
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


def test_where_walls_overlap_the_highest_loss_counts(make_plan):
    light = Wall(name="light", start=(1.0, 2.0), end=(6.0, 2.0), material="glass")
    heavy = Wall(name="heavy", start=(4.0, 2.0), end=(9.0, 2.0))
    for walls in ((light, heavy), (heavy, light)):
        faces = radio_faces(make_plan(walls=walls), Radio(materials={"glass": 2.0})).core()
        assert faces.weight_between((2.0, 1.0), (2.0, 3.0)) == 40
        assert faces.weight_between((5.0, 1.0), (5.0, 3.0)) == 76  # both
        assert faces.weight_between((8.0, 1.0), (8.0, 3.0)) == 76
        assert faces.weight_between((0.0, 2.0), (10.0, 2.0)) == 76  # along both


def test_walls_that_touch_side_by_side_cost_the_thicker_one(make_plan):
    thin = Wall(name="thin", start=(8.0, 0.0), end=(8.0, 10.0), thickness_m=0.1)
    thick = Wall(name="thick", start=(8.15, 0.0), end=(8.15, 10.0), thickness_m=0.2)
    apart = thick.model_copy(update={"start": (8.151, 0.0), "end": (8.151, 10.0)})
    across = ((5.0, 5.0), (15.0, 6.0))
    assert thickness_faces(make_plan(walls=(thin, thick))).core().weight_between(*across) == 2 * 200
    assert thickness_faces(make_plan(walls=(thin, apart))).core().weight_between(*across) == 2 * 300
    assert voice_faces(make_plan(walls=(thin, thick))).core().weight_between(*across) == 2
    assert voice_faces(make_plan(walls=(thin, apart))).core().weight_between(*across) == 4


@pytest.mark.parametrize(("place", "voice"), [((8.1, 11.9), 3), ((8.0, 12.0), 3), ((8.05, 11.95), 3), ((8.5, 11.5), 3)])
def test_block_between_two_walls_counts_in_full_whether_it_touches_them_or_not(make_plan, place, voice):
    # Table 3: 3.8 + 12.4 + 3.8 = 20.0 dB; the block is thicker than 80 cm.
    low, high = place
    walls = tuple(Wall(name=f"w{x:g}", start=(x, 0.0), end=(x, 10.0)) for x in (8.0, 12.0))
    rock = Block(name="rock", polygon=((low, 0.0), (high, 0.0), (high, 10.0), (low, 10.0)))
    plan = make_plan(walls=walls, blocks=(rock,))
    across = ((5.0, 5.0), (15.0, 6.0))
    assert radio_faces(plan, Radio()).core().weight_between(*across) == 20 * 20
    assert voice_faces(plan).core().weight_between(*across) == 2 * voice


def test_blocks_and_pillars_that_touch_are_not_one(make_plan):
    # Three pillars of 40 cm in a row: 3 x 3.9 dB along the row, and half a metre of a block of 5.7 dB next to them.
    squares = [((x, 5.0), (x + 0.4, 5.0), (x + 0.4, 5.4), (x, 5.4)) for x in (5.0, 5.4, 5.8)]
    pillars = tuple(Block(name=f"p{i}", kind="pillar", polygon=square) for i, square in enumerate(squares))
    block = Block(name="block", polygon=((6.2, 5.0), (6.7, 5.0), (6.7, 5.5), (6.2, 5.5)))
    faces = radio_faces(make_plan(blocks=(*pillars, block)), Radio()).core()
    assert faces.weight_between((4.0, 5.2), (8.0, 5.2)) == 3 * 78 + 114


def test_corner_and_junction_of_walls_are_one_wall_drawn_either_way(make_plan):
    level = Wall(name="level", start=(2.0, 5.0), end=(8.1, 5.0))
    for top in (4.9, 5.0, 5.1):  # touching the first wall, up to its centre line, and up to its far side
        upright = Wall(name="upright", start=(8.0, 1.0), end=(8.0, top))
        middle = Wall(name="middle", start=(4.0, 1.0), end=(4.0, top), thickness_m=0.15)
        faces = radio_faces(make_plan(walls=(level, upright, middle)), Radio()).core()
        assert faces.weight_between((8.3, 5.4), (7.6, 4.4)) == 76  # through the corner
        assert faces.weight_between((4.02, 5.4), (3.7, 4.6)) == 76  # through the junction
        assert faces.weight_between((3.5, 5.4), (4.5, 3.0)) == 2 * 76  # through one wall, then through the other


def test_wall_that_joins_two_walls_makes_them_one_along_itself(make_plan):
    # The stated limit of the rule: the only way in which an added wall lowers a loss between free points.
    ends = tuple(Wall(name=f"end_{x:g}", start=(x, 2.0), end=(x, 8.0)) for x in (5.0, 9.0))
    joining = Wall(name="joining", start=(5.0, 5.0), end=(9.0, 5.0))
    along = ((4.0, 5.0), (10.0, 5.0))
    assert radio_faces(make_plan(walls=ends), Radio()).core().weight_between(*along) == 2 * 76
    assert radio_faces(make_plan(walls=(*ends, joining)), Radio()).core().weight_between(*along) == 76


def test_wall_wholly_inside_another_adds_what_its_loss_is_higher(make_plan):
    outer = Wall(name="outer", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.7, material="glass")
    inner = Wall(name="inner", start=(3.0, 5.0), end=(7.0, 5.0), thickness_m=0.5)
    across = ((5.0, 4.0), (5.0, 6.0))
    for glass_db, expected in ((2.0, 114), (8.0, 160)):
        radio = Radio(materials={"glass": glass_db})
        faces = radio_faces(make_plan(walls=(inner, outer)), radio)
        assert faces.core().weight_between(*across) == expected
        if glass_db == 8.0:
            assert _rows(faces) == _rows(radio_faces(make_plan(walls=(outer,)), radio))


def test_crossing_walls_of_two_classes_cost_the_higher_loss_at_the_crossing(make_plan):
    walls = (
        Wall(name="thin", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.2),
        Wall(name="thick", start=(5.0, 2.0), end=(5.0, 8.0), thickness_m=0.7),
    )
    faces = radio_faces(make_plan(walls=walls), Radio()).core()
    assert faces.weight_between((3.0, 4.0), (3.0, 6.0)) == 2 * 38
    assert faces.weight_between((4.0, 7.0), (6.0, 7.0)) == 2 * 124
    assert faces.weight_between((1.0, 5.0), (9.0, 5.0)) == 2 * 124  # along the thin one, through the thick one
    assert faces.weight_between((4.4, 5.6), (5.0, 5.0)) == 124  # to a point in both


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
    faces = voice_faces(flat)  # all walls have one loss; where they have several, faces of two losses share their ends
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
    message = r"^floor: a.material: 'glas' is neither in radio.materials nor in the plan's materials \(glass, brick\)$"
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


def _random_plan(generator: np.random.Generator, count: int, *, walls_meet: bool) -> FloorPlan:
    """Return walls, blocks and pillars at any angle; blocks and pillars touch and overlap everything at random."""
    walls, blocks, built = [], [], shapely.Polygon()
    while len(walls) + len(blocks) < count:
        x, y = generator.uniform(3.0, 17.0, 2)
        along = generator.uniform(-3.0, 3.0, 2) + 0.01
        name = f"e{len(walls) + len(blocks)}"
        if len(walls) <= len(blocks):
            ends = {"start": (x, y), "end": (x + along[0], y + along[1])}
            wall = Wall(name=name, **ends, thickness_m=generator.uniform(0.05, 0.8))
            footprint = shapely.Polygon(wall_corners(wall))
            if walls_meet or not built.intersects(footprint.buffer(0.01)):
                walls.append(wall)
                built = built.union(footprint)
        else:
            angle_rad, width_m = generator.uniform(0.0, np.pi), generator.uniform(0.1, 2.0, 2)
            box = shapely.box(x, y, x + width_m[0], y + width_m[1])
            corners = shapely.get_coordinates(shapely.affinity.rotate(box, angle_rad, use_radians=True))[:-1]
            kind = ("block", "pillar")[len(blocks) % 2]
            blocks.append(Block(name=name, kind=kind, polygon=tuple(corners.tolist())))
    return FloorPlan(name="random", bounds=Bounds(max=(20.0, 20.0)), walls=walls, blocks=blocks)


def _num_walls_crossed(plan: FloorPlan, rays: np.ndarray) -> np.ndarray:
    """Return how many pieces of the union of all walls each ray crosses."""
    union = shapely.union_all([shapely.Polygon(wall_corners(wall)) for wall in plan.walls])
    return shapely.get_num_geometries(shapely.intersection(union, shapely.linestrings(rays)))


@pytest.mark.parametrize("seed", range(4))
def test_element_never_lowers_a_loss_of_radio_or_voice_unless_it_joins_walls(seed):
    generator = np.random.default_rng(seed)
    walls_meet = seed % 2 == 0
    plan = _random_plan(generator, 16, walls_meet=walls_meet)
    if walls_meet:  # of one class, so that only gaps between walls count
        same = tuple(wall.model_copy(update={"thickness_m": 0.2}) for wall in plan.walls)
        plan = plan.model_copy(update={"walls": same})
    rays = generator.uniform(0.0, 20.0, (600, 2, 2))
    if walls_meet:
        inside = shapely.buffer(shapely.union_all([solid.polygon for solid in solids(plan)]), 0.002)
        rays = rays[~np.any(shapely.contains_xy(inside, rays[:, :, 0], rays[:, :, 1]), axis=1)]

    def losses(plan: FloorPlan) -> np.ndarray:
        cores = [radio_faces(plan, Radio()).core(), voice_faces(plan).core(), thickness_faces(plan).core()]
        return np.array([[core.weight_between(tuple(a), tuple(b)) for a, b in rays] for core in cores])

    with_all, crossed = losses(plan), _num_walls_crossed(plan, rays)
    for kind in ("walls", "blocks"):
        elements = getattr(plan, kind)
        for i in range(len(elements)):
            fewer = plan.model_copy(update={kind: elements[:i] + elements[i + 1 :]})
            without = losses(fewer)
            joins = _num_walls_crossed(fewer, rays) > crossed
            assert walls_meet or not joins.any()
            assert np.all((without <= with_all) | joins)
            assert np.any(without < with_all)
            assert np.count_nonzero(joins) < 0.03 * len(rays)


@pytest.mark.parametrize("seed", range(3))
def test_loss_between_free_points_is_the_sum_over_crossed_elements_of_equation_4(seed):
    generator = np.random.default_rng(100 + seed)
    plan = _random_plan(generator, 16, walls_meet=False)
    footprints = [(solid.polygon, solid.element) for solid in solids(plan)]
    faces, voices = radio_faces(plan, Radio()).core(), voice_faces(plan).core()
    compared = 0
    for a, b in generator.uniform(0.0, 20.0, (600, 2, 2)):
        ray = shapely.LineString([a, b])
        if any(ray.distance(shapely.Point(p)) < 0.002 for shape, _ in footprints for p in shape.exterior.coords):
            continue  # so near to a corner that rounding to millimetres decides
        if any(shape.distance(shapely.Point(end)) < 0.002 for shape, _ in footprints for end in (a, b)):
            continue
        crossed = [(shape, element) for shape, element in footprints if shape.intersects(ray)]
        expected_db = sum(_table_3_db(shape, element.thickness_m) for shape, element in crossed)
        assert faces.weight_between(tuple(a), tuple(b)) == round(20 * expected_db)
        assert voices.weight_between(tuple(a), tuple(b)) == 2 * len(crossed)
        compared += len(crossed) > 1
    assert compared > 100


def _table_3_db(footprint: shapely.Polygon, thickness_m: float | None) -> float:
    """Return the loss of Table 3 by thickness, or by width: the shorter side of the least rectangle around a block."""
    if thickness_m is None:
        corners = shapely.get_coordinates(footprint.minimum_rotated_rectangle)
        thickness_m = min(np.hypot(*(corners[1] - corners[0])), np.hypot(*(corners[2] - corners[1])))
    limits = ((0.2005, 3.8), (0.4005, 3.9), (0.6005, 5.7), (np.inf, 12.4))
    return next(loss for limit_m, loss in limits if thickness_m < limit_m)


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
