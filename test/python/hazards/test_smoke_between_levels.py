"""Smoke rises through openings in floors, is conserved, and goes no other way from level to level."""

from __future__ import annotations

import numpy as np
import pytest
from burning import Doors, advance, fire_of

from robotteamsim.hazards import Hazards
from robotteamsim.hazards.topology import topology
from robotteamsim.scenario.floor_plan import FloorPlan

WELL = {"name": "well", "polygon": [[9.0, 2.0], [11.0, 2.0], [11.0, 3.0], [9.0, 3.0]]}
SOOT_G = 250.0 / 20.0 * 0.06
"""Of a fire of 250 kJ: heat over heat of combustion, times the yield."""


def two_levels(*openings: dict[str, object], gap_m: float = 0.5) -> dict[str, object]:
    """Two levels of 6 x 6 m without walls, side by side in the plan, one 3 m above the other."""
    start = 6.0 + gap_m
    upper = {"bounds": {"min": [start, 0], "max": [start + 6.0, 6]}, "origin": [start, 0], "elevation_m": 3.0}
    return {
        "name": "tower",
        "bounds": {"max": [start + 6.0, 6]},
        "levels": [{"name": "L0", "bounds": {"max": [6, 6]}, "elevation_m": 0.0}, {"name": "L1", **upper}],
        "openings": list(openings),
    }


def puff(plan: dict[str, object], **sections: object) -> Hazards:
    """A fire of 250 kJ on the lower level, which is over after 16 s."""
    fuel = {"name": "bin", "center": [3.25, 3.25], "radius_m": 0.2, "growth": "ultra_fast", "load_mj_m2": 1.0}
    return fire_of(plan, {"fuel": [fuel], "ignitions": [{"position": [3.25, 3.25]}], **sections})


def above_g_m3(hazards: Hazards) -> np.ndarray:
    return hazards.field.soot_g_m3[:, 13:]


def test_soot_rises_through_an_opening_and_is_conserved() -> None:
    hazards, following = puff(two_levels(WELL)), 1
    for _ in range(20):
        following = advance(hazards, 20, begin=following)
        assert hazards.soot_g == pytest.approx(SOOT_G, rel=1e-9)
    assert above_g_m3(hazards).min() > 0.0
    advance(hazards, 8000, begin=following)
    assert hazards.soot_g == pytest.approx(SOOT_G, rel=1e-9)
    # 36 m^2 on each level, 2.6 m high.
    even = np.full((12, 12), SOOT_G / (72.0 * 2.6))
    np.testing.assert_allclose(hazards.field.soot_g_m3[:, :12], even, rtol=0.02)
    np.testing.assert_allclose(above_g_m3(hazards), even, rtol=0.02)


@pytest.mark.parametrize("gap_m", [0.5, 0.001])
def test_without_an_opening_neither_smoke_nor_fire_gets_to_a_level_that_is_drawn_beside(gap_m: float) -> None:
    plan = two_levels(gap_m=gap_m)
    fuel = {"name": "carpet", "polygon": [[0, 0], [12, 0], [12, 6], [0, 6]], "growth": "ultra_fast"}
    hazards = fire_of(plan, {"fuel": [fuel], "ignitions": [{"position": [5.75, 3.25]}], "gap_m": 5.0})
    advance(hazards, 300)
    lower, upper = hazards.field.states[:, :12], hazards.field.states[:, 13:]
    assert lower.min() > 0
    assert upper.max() == 0
    assert above_g_m3(hazards).max() == 0.0


def test_hot_smoke_rises_faster_than_cold_smoke() -> None:
    """The same soot, of a fire that heats the air and of one that does not."""
    hot, cold = (puff(two_levels(WELL), heat={"convective_share": share}) for share in (0.7, 0.0))
    for hazards in (hot, cold):
        advance(hazards, 40)
    assert above_g_m3(hot).sum() > 1.2 * above_g_m3(cold).sum() > 0.0


@pytest.mark.parametrize("cell_m", [0.3, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("shift_m", [0.0, 0.13])
def test_an_opening_is_as_large_as_in_the_plan_on_any_grid(cell_m: float, shift_m: float) -> None:
    corners = [[x + shift_m, y + shift_m] for x, y in WELL["polygon"]]
    plan = FloorPlan.model_validate(two_levels({**WELL, "polygon": corners}))
    cells = topology(plan, cell_m)
    assert sum(one.share for one in cells.openings) * cell_m**2 == pytest.approx(2.0)
    for one in cells.openings:
        (row, col), (row_below, col_below) = divmod(one.above, cells.shape[1]), divmod(one.below, cells.shape[1])
        assert abs(row - row_below) * cell_m <= cell_m
        assert abs((col - col_below) * cell_m - 6.5) <= cell_m
        assert (one.area_m2, one.rise_m) == (pytest.approx(2.0), 3.0)


def test_an_opening_over_no_level_lets_nothing_through() -> None:
    """One in the lowest floor, and one beside the level below."""
    plan = two_levels({"name": "pit", "polygon": [[1, 1], [2, 1], [2, 2]]})
    plan["levels"][1]["origin"] = [20.0, 0.0]
    plan["openings"].append(WELL)
    hazards = puff(plan)
    advance(hazards, 60, Doors())
    assert above_g_m3(hazards).max() == 0.0
