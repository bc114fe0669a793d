"""Radio: path loss, links and maps."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from robotteamsim.propagation import RadioField
from robotteamsim.propagation.faces import radio_faces
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import solids
from robotteamsim.scenario.sections import Radio

_EMPTY = FloorPlan(name="empty", bounds=Bounds(max=(200.0, 200.0)))


def _wall_loss_db(plan: FloorPlan, a, b, radio: Radio | None = None) -> float:
    """Return what the walls of a plan add to the loss of free space, to 1e-9 dB."""
    radio = radio or Radio()
    return round(RadioField(plan, radio).path_loss_db(a, b) - RadioField(_EMPTY, radio).path_loss_db(a, b), 9)


@pytest.mark.parametrize(
    ("rssi_dbm", "distance_m", "digit_m"), [(-60, 3.49, 0.01), (-70, 9.42, 0.01), (-80, 25.4, 0.1), (-94, 102.0, 1.0)]
)
def test_free_space_radius_of_each_signal_strength(rssi_dbm, distance_m, digit_m):
    field = RadioField(_EMPTY, Radio())
    nearer, further = distance_m - digit_m / 2, distance_m + digit_m / 2
    assert -field.path_loss_db((5.0, 5.0), (5.0 + nearer, 5.0)) > rssi_dbm
    assert -field.path_loss_db((5.0, 5.0), (5.0 + further, 5.0)) < rssi_dbm


def test_loss_at_one_metre_is_the_constant():
    assert RadioField(_EMPTY, Radio()).path_loss_db((5.0, 5.0), (6.0, 5.0)) == pytest.approx(47.4)


@pytest.mark.parametrize(("thickness_m", "loss_db"), [(0.1, 3.8), (0.2, 3.8), (0.4, 3.9), (0.6, 5.7), (0.8, 12.4)])
@pytest.mark.parametrize("angle_deg", [0, 30, 60, 80])
@pytest.mark.parametrize("turn_deg", [0, 17, 90])
def test_table_3_holds_at_every_angle_of_incidence(make_plan, thickness_m, loss_db, angle_deg, turn_deg):
    def point(length_m: float, direction_deg: float) -> tuple[float, float]:
        direction_rad = math.radians(direction_deg + turn_deg)
        return 10.0 + length_m * math.cos(direction_rad), 10.0 + length_m * math.sin(direction_rad)

    wall = Wall(name="a", start=point(9.0, 90), end=point(9.0, -90), thickness_m=thickness_m)
    assert _wall_loss_db(make_plan(walls=(wall,)), point(8.0, angle_deg), point(-8.0, angle_deg)) == loss_db


@pytest.mark.parametrize(("kind", "loss_db"), [("normal", 1.4), ("fireproof", 10.2)])
def test_door_costs_its_loss_when_closed_and_nothing_when_open(make_plan, kind, loss_db):
    plan = make_plan(doors=(Door(name="d", start=(5.0, 5.0), end=(5.0, 6.0), kind=kind, closed=True),))
    field, free = RadioField(plan, Radio()), RadioField(_EMPTY, Radio())
    way = ((4.0, 5.1), (6.0, 5.8))
    assert field.path_loss_db(*way) - free.path_loss_db(*way) == pytest.approx(loss_db)
    field.set_door("d", False)
    assert field.path_loss_db(*way) == free.path_loss_db(*way)


def test_corner_of_walls_of_two_classes_costs_the_higher_loss(make_plan):
    walls = (
        Wall(name="thin", start=(5.0, 5.0), end=(10.0, 5.0), thickness_m=0.2),
        Wall(name="thick", start=(5.0, 4.9), end=(5.0, 10.0), thickness_m=0.7),
    )
    way = ((7.2, 4.4), (4.0, 5.6))  # in through the lower face of the thin wall, out through the left one of the thick
    assert _wall_loss_db(make_plan(walls=walls), *way) == pytest.approx(12.4)


@pytest.mark.parametrize("y_m", [4.9, 5.0, 5.1])
def test_grazing_along_a_wall_costs_at_most_that_wall(make_plan, y_m):
    plan = make_plan(walls=(Wall(name="a", start=(5.0, 5.0), end=(15.0, 5.0)),))
    assert _wall_loss_db(plan, (1.0, y_m), (19.0, y_m)) in (0.0, 3.8)


def test_transmitter_in_a_wall_loses_half_of_it_in_both_directions(make_plan):
    plan = make_plan(walls=(Wall(name="a", start=(5.0, 5.0), end=(15.0, 5.0), thickness_m=0.7),))
    assert _wall_loss_db(plan, (8.0, 5.1), (9.0, 9.0)) == pytest.approx(6.2)
    assert _wall_loss_db(plan, (9.0, 9.0), (8.0, 5.1)) == pytest.approx(6.2)


def test_distances_below_the_limit_count_as_the_limit():
    field = RadioField(_EMPTY, Radio(min_distance_m=0.5))
    assert field.path_loss_db((1.0, 1.0), (1.0, 1.0)) == field.path_loss_db((1.0, 1.0), (1.5, 1.0))


def test_positions_are_rounded_to_whole_millimetres(flat):
    field = RadioField(flat, Radio())
    assert field.path_loss_db((1.0, 1.0), (15.0, 18.0)) == field.path_loss_db((1.0004, 0.9996), (15.0, 18.0))


_POINT = st.tuples(st.floats(-1.0, 21.0), st.floats(-1.0, 21.0))


@settings(max_examples=300)
@given(a=_POINT, b=_POINT)
def test_loss_is_bitwise_equal_in_both_directions(flat_field, a, b):
    assert flat_field.path_loss_db(a, b) == flat_field.path_loss_db(b, a)


def test_loss_is_bitwise_equal_in_both_directions_through_all_corners():
    walls = (
        Wall(name="a", start=(2.0, 5.0), end=(8.0, 5.0), thickness_m=0.8),
        Wall(name="b", start=(5.0, 2.0), end=(5.0, 8.0), thickness_m=0.4),
    )
    field = RadioField(FloorPlan(name="cross", bounds=Bounds(max=(10.0, 10.0)), walls=walls), Radio())
    lattice = [(x * 0.2, y * 0.2) for x in range(9, 42, 2) for y in range(9, 42, 2)]
    rssi_dbm = np.array([[field.path_loss_db(a, b) for b in lattice] for a in lattice])
    assert np.array_equal(rssi_dbm, rssi_dbm.T)


@pytest.fixture(scope="module")
def flat_field() -> RadioField:
    walls = (
        Wall(name="a", start=(2.0, 5.0), end=(18.0, 5.0), thickness_m=0.8),
        Wall(name="b", start=(5.0, 2.0), end=(5.0, 18.0), thickness_m=0.4),
        Wall(name="c", start=(3.0, 17.0), end=(17.0, 4.0), thickness_m=0.2),
    )
    return RadioField(FloorPlan(name="crossings", bounds=Bounds(max=(20.0, 20.0)), walls=walls), Radio())


@settings(max_examples=100)
@given(x=st.integers(0, 40), y=st.integers(0, 40), dx=st.integers(-3, 3), dy=st.integers(-3, 3))
def test_wall_loss_never_falls_along_a_ray(x, y, dx, dy):
    walls = (
        Wall(name="a", start=(4.0, 10.0), end=(16.0, 10.0), thickness_m=0.8),
        Wall(name="b", start=(10.0, 4.0), end=(10.0, 16.0), thickness_m=0.4),
        Wall(name="c", start=(4.0, 4.0), end=(16.0, 16.0)),
    )
    faces = radio_faces(FloorPlan(name="star", bounds=Bounds(max=(20.0, 20.0)), walls=walls), Radio()).core()
    a = (x / 2, y / 2)
    along = [faces.weight_between(a, (a[0] + k * dx / 5, a[1] + k * dy / 5)) for k in range(60)]
    assert along == sorted(along)


def test_crossed_faces_agree_with_shapely(flat):
    faces = radio_faces(flat, Radio(pillars=False))
    segments = shapely.linestrings(faces.ends_mm.reshape(-1, 2, 2))
    vertices = shapely.points(faces.ends_mm.reshape(-1, 2))
    core = faces.core()
    open_door = faces.door_face("glass")
    generator = np.random.default_rng(5)
    compared = 0
    for a_mm, b_mm in generator.integers(0, 20_000, size=(400, 2, 2)):
        way = shapely.LineString([a_mm, b_mm])
        if np.min(shapely.distance(vertices, way)) < 1e-3:
            continue  # through a corner: a tie that only exact arithmetic decides
        crossed = shapely.intersects(segments, way)
        crossed[open_door] = False
        assert core.weight_between(tuple(a_mm / 1000), tuple(b_mm / 1000)) == faces.weights[crossed].sum()
        compared += 1
    assert compared > 390


def test_separate_solids_cost_the_sum_of_their_losses(make_plan):
    pillars = tuple(
        Block(name=f"p{i}{j}", kind="pillar", polygon=((x, y), (x + w, y), (x + w, y + 0.5), (x, y + 0.5)))
        for i, w in enumerate((0.1, 0.3, 0.5))
        for j in range(3)
        for x, y in [(4.0 + 5 * i, 3.0 + 6 * j)]
    )
    plan = make_plan(blocks=pillars)
    outlines = shapely.union_all([solid.polygon for solid in solids(plan)])
    loss_db = {"0": 3.8, "1": 3.9, "2": 5.7}
    generator = np.random.default_rng(6)
    for a, b in generator.uniform(0.5, 19.5, size=(300, 2, 2)).round(3):
        if shapely.intersects(outlines, shapely.points([a, b])).any():
            continue
        way = shapely.LineString([a, b])
        expected = sum(loss_db[s.name[1]] for s in solids(plan) if shapely.intersects(s.polygon, way))
        assert _wall_loss_db(plan, tuple(a), tuple(b)) == pytest.approx(expected, abs=1e-6)


def test_rssi_matrix_is_transmit_power_minus_path_loss(flat):
    field = RadioField(flat, Radio(tx_power_dbm=12.0))
    positions_m = np.random.default_rng(7).uniform(0.0, 20.0, size=(12, 2))
    rssi_dbm = field.rssi_matrix_dbm(positions_m)
    assert rssi_dbm.shape == (12, 12)
    assert np.array_equal(rssi_dbm, rssi_dbm.T)
    assert not rssi_dbm.diagonal().any()
    assert rssi_dbm[3, 8] == 12.0 - field.path_loss_db(tuple(positions_m[3]), tuple(positions_m[8]))


MAP_ERROR_DB = 4e-5


def test_rssi_map_is_the_signal_at_every_cell_centre(flat):
    field = RadioField(flat, Radio(tx_power_dbm=12.0))
    tx_m = (4.5, 7.25)
    for floors_crossed in (0, 2):
        rssi_map = field.rssi_map_dbm(tx_m, 0.5, floors_crossed=floors_crossed)
        assert rssi_map.values.shape == (40, 40)
        assert rssi_map.values.dtype == np.float32
        for row, column in np.ndindex(40, 40):
            rssi_dbm = 12.0 - field.path_loss_db(tx_m, rssi_map.cell_center(row, column), floors_crossed)
            assert rssi_map.values[row, column] == pytest.approx(rssi_dbm, abs=MAP_ERROR_DB)


def test_map_of_several_transmitters_is_the_best_of_their_maps(flat):
    field = RadioField(flat, Radio())
    transmitters_m = [(4.5, 7.25), (18.0, 2.0), (10.0, 19.0)]
    maps = field.rssi_maps_dbm(transmitters_m, 0.25, threads=2)
    assert [part.values.tobytes() for part in maps] == [
        field.rssi_map_dbm(tx_m, 0.25).values.tobytes() for tx_m in transmitters_m
    ]
    best = field.best_rssi_map_dbm(transmitters_m, 0.25)
    assert np.array_equal(best.values, np.max([part.values for part in maps], axis=0))


def test_map_is_written_into_the_array_given(flat):
    field = RadioField(flat, Radio())
    out = np.empty((40, 40), dtype=np.float32)
    assert field.rssi_map_dbm((4.5, 7.25), 0.5, out=out).values is out
    assert out.tobytes() == field.rssi_map_dbm((4.5, 7.25), 0.5).values.tobytes()


def test_threads_do_not_change_a_bit_of_a_map(flat):
    field = RadioField(flat, Radio())
    transmitters_m = [(4.5, 7.25), (18.0, 2.0), (10.0, 19.0), (8.3, 7.3)]
    best = field.best_rssi_map_dbm(transmitters_m, 0.05).values.tobytes()
    each = [part.values.tobytes() for part in field.rssi_maps_dbm(transmitters_m, 0.05)]
    for threads in (0, 2, 3, 7):
        assert field.best_rssi_map_dbm(transmitters_m, 0.05, threads=threads).values.tobytes() == best
        maps = field.rssi_maps_dbm(transmitters_m, 0.05, threads=threads)
        assert [part.values.tobytes() for part in maps] == each


@pytest.mark.parametrize(
    "out",
    [
        np.empty((40, 41), dtype=np.float32),
        np.empty((40, 40), dtype=np.float64),
        np.empty((80, 80), dtype=np.float32)[::2, ::2],
        np.broadcast_to(np.float32(0.0), (40, 40)),
    ],
    ids=["shape", "dtype", "strided", "read-only"],
)
def test_array_that_a_map_does_not_fit_is_rejected(flat, out):
    with pytest.raises(ValueError, match=r"^out must be float32, C-contiguous, writeable, of shape \(40, 40\), got "):
        RadioField(flat, Radio()).rssi_map_dbm((4.5, 7.25), 0.5, out=out)


def test_no_transmitter_is_rejected(flat):
    field = RadioField(flat, Radio())
    with pytest.raises(ValueError, match="a map needs at least one source"):
        field.best_rssi_map_dbm([], 0.5)
    with pytest.raises(ValueError, match="a map needs at least one source"):
        field.rssi_maps_dbm([], 0.5)


def test_loss_of_crossed_floors_equals_equation_4(flat):
    field = RadioField(flat, Radio(floor_loss_db=18.3, floor_exponent=0.46))
    a_m, b_m = (4.5, 7.25), (12.0, 8.0)
    same_floor_db = field.path_loss_db(a_m, b_m)
    for floors_crossed in (1, 2, 3):
        k = floors_crossed
        expected_db = same_floor_db + k ** ((k + 2) / (k + 1) - 0.46) * 18.3
        assert field.path_loss_db(a_m, b_m, floors_crossed) == pytest.approx(expected_db)
    with pytest.raises(ValueError, match="floors_crossed must be >= 0, got -1"):
        field.path_loss_db(a_m, b_m, -1)


def test_door_opened_and_closed_restores_the_map_to_the_bit(flat):
    field = RadioField(flat, Radio())
    before = field.rssi_map_dbm((9.4, 14.0), 0.25).values
    field.set_door("glass", True)
    closed = field.rssi_map_dbm((9.4, 14.0), 0.25).values
    assert np.any(closed < before)
    field.set_door("glass", False)
    assert field.rssi_map_dbm((9.4, 14.0), 0.25).values.tobytes() == before.tobytes()


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_position_that_is_not_finite_is_rejected_with_its_place(flat, bad):
    field = RadioField(flat, Radio())
    with pytest.raises(ValueError, match=r"^position of robot 1 must be finite"):
        field.rssi_matrix_dbm(np.array([[1.0, 1.0], [2.0, bad]]))
    with pytest.raises(ValueError, match=r"^b_m must be finite"):
        field.path_loss_db((1.0, 1.0), (bad, 1.0))
    with pytest.raises(ValueError, match=r"^tx_m must be finite"):
        field.rssi_map_dbm((bad, 1.0), 0.5)


def test_positions_of_another_shape_are_rejected(flat):
    with pytest.raises(ValueError, match=r"^positions_m must have shape \(n, 2\), got \(3, 3\)$"):
        RadioField(flat, Radio()).rssi_matrix_dbm(np.zeros((3, 3)))


def test_unknown_door_is_rejected_by_name(flat):
    with pytest.raises(ValueError, match="unknown door 'back'"):
        RadioField(flat, Radio()).set_door("back", True)


def test_beyond_the_bounds_of_a_plan_is_free_space(make_plan):
    plan = make_plan(walls=(Wall(name="a", start=(2.0, 1.0), end=(2.0, 9.0)),))
    wider = plan.model_copy(update={"bounds": Bounds(min=(-50.0, -50.0), max=(50.0, 50.0))})
    outside, inside = (-7.5, 3.25), (6.0, 4.0)
    field, wide_field = RadioField(plan, Radio()), RadioField(wider, Radio())
    assert field.path_loss_db(outside, inside) == wide_field.path_loss_db(outside, inside)
    part = field.rssi_map_dbm(outside, 0.5)
    assert part.values.shape == (40, 40)
    whole = wide_field.rssi_map_dbm(outside, 0.5).values
    np.testing.assert_array_equal(part.values, whole[100:140, 100:140])
