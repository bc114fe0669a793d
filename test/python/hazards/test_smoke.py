"""Smoke and heat in the air: soot is conserved, spreads as diffusion does, and dims light."""

from __future__ import annotations

import math

import numpy as np
import pytest
from burning import HALL, LARGE_HALL, ROOMS, Doors, advance, fire_of, rooms_with_door

from robotteamsim import _core
from robotteamsim.hazards import Hazards


def puff(plan: dict[str, object], place: tuple[float, float], **sections: object) -> Hazards:
    """A small fire of 250 kJ, which is over after 16 s."""
    fuel = {"name": "bin", "center": list(place), "radius_m": 0.2, "growth": "ultra_fast", "load_mj_m2": 1.0}
    return fire_of(plan, {"fuel": [fuel], "ignitions": [{"position": list(place)}], **sections})


SOOT_G = 250.0 / 20.0 * 0.06
"""Of a puff: heat over heat of combustion, times the yield."""


def test_soot_is_conserved_while_doors_open_and_close():
    hazards, doors = puff(ROOMS, (3.25, 3.25)), Doors(door=True)
    begin = advance(hazards, 20, doors)
    for round_ in range(200):
        doors.set("door", round_ % 3 != 0)
        begin = advance(hazards, 5, doors, begin)
        assert hazards.soot_g == pytest.approx(SOOT_G, rel=1e-9)
    assert hazards.field.soot_g_m3.min() > 0.0


def test_soot_spreads_evenly_over_connected_rooms():
    hazards = puff(ROOMS, (3.25, 3.25))
    advance(hazards, 8000, Doors(door=False))
    # 72 m^2, 2.6 m high.
    assert hazards.field.soot_g_m3 == pytest.approx(np.full((12, 24), SOOT_G / (72.0 * 2.6)), rel=0.01)


def test_variance_of_a_puff_grows_by_two_diffusivities_per_second_along_each_axis():
    hazards = puff(LARGE_HALL, (20.25, 20.25))
    following = advance(hazards, 20)
    before = variances_m2(hazards)
    advance(hazards, 10, begin=following)
    assert variances_m2(hazards) - before == pytest.approx(np.full(2, 2 * 0.15 * 10), rel=1e-3)


def variances_m2(hazards: Hazards) -> np.ndarray:
    soot = hazards.field.soot_g_m3.astype(float)
    rows, cols = np.mgrid[0 : soot.shape[0], 0 : soot.shape[1]] * 0.5
    means = [np.average(places, weights=soot) for places in (rows, cols)]
    pairs = zip((rows, cols), means, strict=True)
    return np.array([np.average((places - mean) ** 2, weights=soot) for places, mean in pairs])


def test_air_is_as_hot_as_the_heat_in_it_and_cools():
    # Without losses, 70 % of 250 kJ warm the air.
    hazards = puff(HALL, (10.25, 10.25), heat={"convection_w_m2_k": 0.0, "emissivity": 0.0})
    following = advance(hazards, 30)
    excess_k = hazards.field.temperatures_c.astype(float) - 20.0
    assert excess_k.sum() * 0.25 * 2.6 * 1.204 * 1.005 == pytest.approx(0.7 * 250.0, rel=1e-4)
    advance(hazards, 1000, begin=following)
    assert excess_k.sum() > 0.0
    losing = puff(HALL, (10.25, 10.25))
    advance(losing, 1030)
    assert (losing.field.temperatures_c - 20.0).sum() < 0.01 * excess_k.sum()


def test_leak_of_a_closed_door_lets_less_smoke_through_than_an_open_one():
    def beyond(closed: bool, leakage: float) -> float:
        hazards = puff(ROOMS, (3.25, 3.25), soot={"door_leakage": leakage})
        advance(hazards, 120, Doors(door=closed))
        return float(hazards.field.soot_g_m3[:, 12:].sum())

    assert 0.0 < beyond(True, 0.01) < 0.2 * beyond(False, 0.01)
    assert beyond(True, 0.0) == 0.0


@pytest.mark.parametrize("cell_m", [0.25, 0.5, 1.0])
@pytest.mark.parametrize(("low_m", "high_m"), [(2.4, 3.6), (2.6, 3.5), (2.85, 3.45)])
def test_leak_of_a_closed_door_depends_on_its_width_and_not_on_the_grid(cell_m, low_m, high_m):
    assert beyond(cell_m, low_m, high_m, True, 1500) == pytest.approx(leaked(high_m - low_m, 1500), rel=0.06)


def test_leak_does_not_depend_on_whether_the_centres_of_cells_are_in_the_leaf():
    # Everything is 0.125 m farther to the right: with cells of 0.25 m, centres are in walls and leaf.
    plan = rooms_with_door(2.4, 3.6)
    for element in (*plan["walls"], *plan["doors"]):
        element.update({end: [element[end][0] + 0.125, element[end][1]] for end in ("from", "to")})
    bin_ = {"name": "bin", "polygon": [[2, 2], [3, 2], [3, 3], [2, 3]], "growth": "ultra_fast", "load_mj_m2": 1.0}
    hazards = fire_of(plan, {"fuel": [bin_], "ignitions": [{"position": [2.6, 2.6]}], "cell_m": 0.25})
    advance(hazards, 1500, Doors(door=True))
    soot = hazards.field.soot_g_m3.astype(float)
    assert soot[:, 25:].sum() / soot.sum() == pytest.approx(leaked(1.2, 1500), rel=0.1)


def leaked(width_m: float, seconds: float) -> float:
    """Share of the soot beyond a closed door between two rooms of 36 m^2 in which it is spread evenly.

    The leaf of leakage 0.01 conducts 0.01 * D * width / 0.5 m, so the difference decays at twice that over 36 m^2.
    """
    return 0.5 * (1.0 - math.exp(-2 * 0.01 * 0.15 * width_m / 0.5 * seconds / 36.0))


@pytest.mark.slow
@pytest.mark.parametrize(("low_m", "high_m"), [(2.4, 3.6), (2.6, 3.5), (2.3, 3.2), (2.85, 3.45)])
def test_flow_through_an_open_door_depends_little_on_the_grid(low_m, high_m):
    # Cells of 0.1 m see the length of the doorway through the wall, 0.2 m, and are nearest to the limit.
    finest, *shares = [beyond(cell_m, low_m, high_m, False, 300) for cell_m in (0.1, 0.25, 0.5, 1.0)]
    assert shares[0] == pytest.approx(finest, rel=0.15)
    assert shares[1:] == pytest.approx(np.full(2, finest), rel=0.08)


def beyond(cell_m: float, low_m: float, high_m: float, closed: bool, seconds: int) -> float:
    """Share of the soot in the other room."""
    bin_ = {"name": "bin", "polygon": [[2, 2], [3, 2], [3, 3], [2, 3]], "growth": "ultra_fast", "load_mj_m2": 1.0}
    fire = {"fuel": [bin_], "ignitions": [{"position": [2.6, 2.6]}], "cell_m": cell_m}
    hazards = fire_of(rooms_with_door(low_m, high_m), fire)
    advance(hazards, seconds, Doors(door=closed))
    soot = hazards.field.soot_g_m3.astype(float)
    return float(soot[:, soot.shape[1] // 2 :].sum() / soot.sum())


@pytest.mark.parametrize("soot", [-1.0, math.nan, math.inf])
def test_soot_must_be_a_number_of_at_least_0(soot):
    with pytest.raises(ValueError, match="soot must be finite and >= 0"):
        _core.hazards.Haze((0.0, 0.0), 0.5, np.full((2, 2), soot, dtype=np.float32), 8.7, 1.5)
