"""Radio and voices between the levels of a building, compared with rays that shapely cuts."""

import itertools
import math

import numpy as np
import pytest
import shapely

from robotteamsim.propagation import RadioField, VoiceField, VoiceSource
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.levels import Level, Opening
from robotteamsim.scenario.materials import Layer, Material
from robotteamsim.scenario.sections import Radio, Voice

HEIGHT_M = 0.5
"""Of both ends of a ray above their floors."""
RISES_M = (0.0, 3.0, 7.0)
ORIGINS = ((2.0, 1.0), (24.0, 3.0), (46.0, 2.0))
WIDTH_M, DEPTH_M = 18.0, 12.0


def make_building(rng: np.random.Generator | None = None, **keys: object) -> FloorPlan:
    """Return three levels side by side, with random walls."""
    walls, levels = [], []
    for i, ((x, y), rise_m) in enumerate(zip(ORIGINS, RISES_M, strict=True)):
        bounds = Bounds(min=(x - 1.0, y - 1.0), max=(x + WIDTH_M, y + DEPTH_M))
        levels.append(Level(name=f"L{i}", bounds=bounds, origin=(x, y), elevation_m=rise_m))
        for k in range(12 if rng is not None else 0):
            ends = [tuple(np.round(rng.uniform((x, y), (x + 16.0, y + 10.0)), 3).tolist()) for _ in range(2)]
            walls.append(Wall(name=f"wall_{i}_{k}", start=ends[0], end=ends[1], thickness_m=0.15))
    return FloorPlan(
        name="tower", bounds=Bounds(min=(0.0, 0.0), max=(70.0, 20.0)), walls=walls, **{"levels": levels, **keys}
    )


def expected_loss_db(plan: FloorPlan, field: RadioField, radio: Radio, a: tuple[int, np.ndarray], b: tuple) -> float:
    """Return the loss between two points, each a level and a place in the building, by eq. (4) in space."""
    (i, p), (j, q) = sorted((a, b), key=lambda point: point[0])
    z0, z1 = RISES_M[i] + HEIGHT_M, RISES_M[j] + HEIGHT_M
    distance_m = math.sqrt(float(np.sum((p - q) ** 2)) + (z1 - z0) ** 2)
    ends_mm, weights = field._faces.ends_mm, field._faces.weights
    units = 0.0
    for k, (origin, rise_m) in enumerate(zip(ORIGINS, RISES_M, strict=True)):
        top_m = RISES_M[k + 1] if k < 2 else rise_m + 3.0
        low, high = max(z0, rise_m), min(z1, top_m)
        if high <= low:
            continue
        ends = [p + (q - p) * (z - z0) / (z1 - z0) + origin for z in (low, high)]
        ray = shapely.LineString(ends)
        for (x0, y0, x1, y1), weight in zip(ends_mm / 1000.0, weights, strict=True):
            units += float(weight) * ray.intersects(shapely.LineString([(x0, y0), (x1, y1)]))
    floors = j - i
    floors_db = floors ** ((floors + 2) / (floors + 1) - radio.floor_exponent) * radio.floor_loss_db
    slope_db = radio.constant_loss_db + radio.slope_db * math.log10(distance_m)
    return slope_db + units / 20.0 + floors_db


@pytest.mark.parametrize("seed", range(6))
def test_the_loss_between_levels_is_that_of_a_straight_ray_in_space(seed: int) -> None:
    rng = np.random.default_rng(seed)
    plan, radio = make_building(rng), Radio()
    field = RadioField(plan, radio)
    worst_db = []
    for _ in range(200):
        i, j = rng.choice(3, 2, replace=False).tolist()
        p, q = np.round(rng.uniform((0.0, 0.0), (16.0, 10.0), (2, 2)), 3)
        found_db = field.path_loss_db(tuple(p + ORIGINS[i]), tuple(q + ORIGINS[j]))
        assert found_db == field.path_loss_db(tuple(q + ORIGINS[j]), tuple(p + ORIGINS[i]))
        worst_db.append(abs(found_db - expected_loss_db(plan, field, radio, (i, p), (j, q))))
    # A ray is cut at whole millimetres: where a wall ends there, it may be on the other side.
    assert np.quantile(worst_db, 0.98) < 1e-3


def test_floors_cost_what_cost_231_measured() -> None:
    """The goals of COST 231: 18.3 dB for one floor, 33.5 dB for two, 43.6 dB for three."""
    origins = [(20.0 * k, 0.0) for k in range(4)]
    levels = [
        Level(name=f"L{k}", bounds=Bounds(min=(x - 5, -5.0), max=(x + 5, 5.0)), origin=(x, y), elevation_m=3.0 * k)
        for k, (x, y) in enumerate(origins)
    ]
    plan = FloorPlan(name="tower", bounds=Bounds(min=(-5.0, -5.0), max=(70.0, 5.0)), levels=levels)
    radio = Radio()
    field = RadioField(plan, radio)
    for floors, loss_db in ((1, 18.3), (2, 33.5), (3, 43.6)):
        over_distance_db = radio.constant_loss_db + radio.slope_db * math.log10(3.0 * floors)
        assert field.path_loss_db(origins[0], origins[floors]) - over_distance_db == pytest.approx(loss_db, abs=0.05)


def test_a_floor_of_a_material_costs_what_its_layers_do() -> None:
    """200 mm of concrete: 14.7 dB at 2.45 GHz [itu_p2040]; the other floors stay those of COST 231."""
    slab = Material(name="slab", layers=(Layer(of="concrete", thickness_m=0.2),))
    levels = list(make_building().levels)
    levels[1] = levels[1].model_copy(update={"floor_material": "slab"})
    radio = Radio(walls="material", frequency_mhz=2450.0)
    counted = RadioField(make_building(), radio)
    field = RadioField(make_building(levels=levels, materials=(slab,)), radio)
    places = [(x + 5.0, y + 5.0) for x, y in ORIGINS]
    assert field.path_loss_db(places[0], places[1]) == pytest.approx(
        counted.path_loss_db(places[0], places[1]) - 18.3 + 14.7, abs=0.05
    )
    two_db = radio.constant_loss_db + radio.slope_db * math.log10(7.0)
    assert field.path_loss_db(places[0], places[2]) == pytest.approx(two_db + 14.7 + 18.3, abs=0.05)


def test_openings_cost_nothing() -> None:
    x, y = ORIGINS[1]
    well = Opening(name="well", polygon=((x + 4, y + 4), (x + 6, y + 4), (x + 6, y + 6), (x + 4, y + 6)))
    field = RadioField(make_building(openings=(well,)), Radio())
    (x0, y0), (x2, y2) = ORIGINS[0], ORIGINS[2]
    radio = Radio()
    through_db = field.path_loss_db((x0 + 5.0, y0 + 5.0), (x + 5.0, y + 5.0))
    assert through_db == pytest.approx(radio.constant_loss_db + radio.slope_db * math.log10(3.0), abs=1e-9)
    beside_db = field.path_loss_db((x0 + 9.0, y0 + 5.0), (x + 9.0, y + 5.0))
    assert beside_db == pytest.approx(through_db + 18.3, abs=1e-9)
    two_db = radio.constant_loss_db + radio.slope_db * math.log10(7.0)
    assert field.path_loss_db((x0 + 5.0, y0 + 5.0), (x2 + 5.0, y2 + 5.0)) == pytest.approx(two_db + 18.3, abs=1e-9)


@pytest.mark.parametrize("num_robots", [12, 60])
def test_links_of_a_team_are_those_of_its_pairs(num_robots: int) -> None:
    rng = np.random.default_rng(1)
    field = RadioField(make_building(rng), Radio())
    on = rng.integers(0, 3, num_robots)
    positions_m = rng.uniform((0.0, 0.0), (16.0, 10.0), (num_robots, 2)) + np.array(ORIGINS)[on]
    rssi_dbm = field.rssi_matrix_dbm(positions_m)
    for i, j in itertools.permutations(range(num_robots), 2):
        assert rssi_dbm[i, j] == Radio().tx_power_dbm - field.path_loss_db(tuple(positions_m[i]), tuple(positions_m[j]))


@pytest.mark.parametrize("threads", [1, 3])
def test_maps_are_those_of_single_points_on_all_levels(threads: int) -> None:
    rng = np.random.default_rng(2)
    field, tx_dbm = RadioField(make_building(rng), Radio()), Radio().tx_power_dbm
    transmitters = [tuple(np.round(rng.uniform((0, 0), (16, 10)) + ORIGINS[k], 3).tolist()) for k in (0, 2, 2)]
    found = field.best_rssi_map_dbm(transmitters, 0.5, threads=threads)
    each = field.rssi_maps_dbm(transmitters, 0.5, threads)
    np.testing.assert_array_equal(found.values, np.max([one.values for one in each], axis=0))
    level = make_building().levels[1]
    part = field.best_rssi_map_dbm(transmitters, 0.5, bounds=level.bounds, threads=threads)
    row, column = found.cell_at(*part.cell_center(0, 0))
    np.testing.assert_array_equal(
        part.values, found.values[row : row + part.values.shape[0], column : column + part.values.shape[1]]
    )
    on_levels = 0
    for row, column in np.ndindex(found.values.shape):
        x, y = found.cell_center(row, column)
        on = any(a - 1 <= x <= a + WIDTH_M and b - 1 <= y <= b + DEPTH_M for a, b in ORIGINS)
        expected_dbm = max(tx_dbm - field.path_loss_db(one, (x, y)) for one in transmitters) if on else -1000.0
        assert found.values[row, column] == pytest.approx(expected_dbm, abs=1e-3)
        on_levels += on
    assert on_levels > 1000


def test_voices_pass_floors_with_their_loss() -> None:
    voice = Voice(floor_loss_db=30.0, noise_db=0.0)
    (x0, y0), (x1, y1), _ = ORIGINS
    field = VoiceField(make_building(), voice)
    source = VoiceSource((x0 + 5.0, y0 + 5.0), -78.0, 5.0)
    above_db = field.level_db(source, (x1 + 5.0, y1 + 5.0))
    assert above_db == pytest.approx(78.0 - 50.0 * math.log10(3.0) - 30.0, abs=1e-9)
    levels_db = field.map_db([source])
    assert levels_db.value_at(x1 + 5.0, y1 + 5.0) == pytest.approx(above_db, abs=0.5)  # of the cell's centre
    silent = VoiceField(make_building(), voice.model_copy(update={"noise_db": above_db + 1.0}))
    assert silent.map_db([source]).value_at(x1 + 5.0, y1 + 5.0) == 0.0


def test_one_level_is_what_a_plan_without_levels_is() -> None:
    rng = np.random.default_rng(3)
    walls = [
        Wall(name=f"w{k}", start=tuple(rng.uniform(1, 19, 2).tolist()), end=tuple(rng.uniform(1, 19, 2).tolist()))
        for k in range(10)
    ]
    door = Door(name="door", start=(1.0, 1.0), end=(2.0, 1.0), closed=True)
    bounds = Bounds(min=(0.0, 0.0), max=(20.0, 20.0))
    flat = FloorPlan(name="flat", bounds=bounds, walls=walls, doors=(door,))
    level = flat.model_copy(update={"levels": (Level(name="L1", bounds=bounds, elevation_m=4.0),)})
    positions_m = rng.uniform(0, 20, (40, 2))
    plain, levelled = (RadioField(plan, Radio()) for plan in (flat, level))
    np.testing.assert_array_equal(plain.rssi_matrix_dbm(positions_m), levelled.rssi_matrix_dbm(positions_m))
    np.testing.assert_array_equal(
        plain.rssi_map_dbm((3.0, 4.0), 0.1).values, levelled.rssi_map_dbm((3.0, 4.0), 0.1).values
    )
