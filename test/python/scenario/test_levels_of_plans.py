"""Levels, openings and passages that cannot be, and what their ways are."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import ceiling_height_m, ways
from robotteamsim.scenario.problems import checked


def plan_keys(**changed: Any) -> dict[str, Any]:
    """Return three levels of 10 x 10 m side by side, 3 m above one another, with a lift and stairs."""
    levels = [
        {
            "name": f"L{k}",
            "bounds": {"min": [20.0 * k, 0.0], "max": [20.0 * k + 10.0, 10.0]},
            "origin": [20.0 * k, 0.0],
            "elevation_m": 3.0 * k,
        }
        for k in range(3)
    ]
    passages = [
        {"name": "lift", "stops": [[20.0 * k + 2.0, 2.0] for k in range(3)], "wait_s": 4.0, "speed_mps": 2.0},
        {"name": "stairs", "kind": "stairs", "stops": [[20.0 * k + 8.0, 2.0 + 4.0 * k] for k in range(3)]},
    ]
    openings = [{"name": "well", "polygon": [[21.0, 1.0], [22.0, 1.0], [22.0, 2.0]]}]
    bounds = {"min": [0.0, 0.0], "max": [50.0, 10.0]}
    keys = {"name": "tower", "bounds": bounds, "levels": levels, "passages": passages, "openings": openings}
    return keys | changed


def with_level(index: int, **changed: Any) -> dict[str, Any]:
    keys = plan_keys()
    keys["levels"][index] |= changed
    return keys


def wall(start: list[float], end: list[float]) -> dict[str, Any]:
    return {"name": "wall", "from": start, "to": end}


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        (with_level(1, elevation_m=0.0), "levels.1.elevation_m: 0 is also that of levels.0 (in 'L1')"),
        (
            with_level(1, bounds={"min": [10.0, 0.0], "max": [30.0, 10.0]}),
            "levels.1.bounds: [10, 0] .. [30, 10] touches levels.0, [0, 0] .. [10, 10] (in 'L1')",
        ),
        (
            with_level(2, bounds={"min": [40.0, 0.0], "max": [60.0, 10.0]}),
            "levels.2.bounds: [40, 0] .. [60, 10] lies outside the bounds of the plan, [0, 0] .. [50, 10] (in 'L2')",
        ),
        (with_level(1, elevation_m=0.0001), "levels.1.elevation_m: 0.0001 is also that of levels.0 (in 'L1')"),
        (with_level(1, origin=[1e9, 0.0]), "levels.1.origin: [1e+09, 0] is more than 100 km from 0 (in 'L1')"),
        (
            with_level(1, origin=[0.0, 0.0]),
            "passages.0.stops.1: is 20 m beside the lowest stop; expected above it by the origins of the levels",
        ),
        (with_level(2, name="L1"), "levels.2.name: 'L1' is already the name of another"),
        (with_level(0, height_m=0.0), "levels.0.height_m: 0.0 is below 0.5 (in 'L0')"),
        (with_level(0, elevation_m=math.nan), "levels.0.elevation_m: .nan is not a finite number (in 'L0')"),
        (plan_keys(levels=[]), "openings.0: needs levels"),
        (plan_keys(levels=[], openings=[]), "passages.0: needs levels"),
        (
            plan_keys(passages=[{"name": "a", "stops": [[2.0, 2.0], [15.0, 2.0]]}]),
            "passages.0.stops.1: [15, 2] is on no level (in 'a')",
        ),
        (
            plan_keys(passages=[{"name": "a", "stops": [[22.0, 2.0], [2.0, 2.0]]}]),
            "passages.0.stops.1: is not on a higher level than the stop before (in 'a')",
        ),
        (
            plan_keys(passages=[{"name": "a", "stops": [[2.0, 2.0]]}]),
            "passages.0.stops: has 1 item; expected at least 2 (in 'a')",
        ),
        (
            plan_keys(openings=[{"name": "o", "polygon": [[5.0, 1.0], [25.0, 1.0], [25.0, 2.0]]}]),
            "openings.0.polygon: lies on more than one level (in 'o')",
        ),
        (
            plan_keys(openings=[{"name": "o", "polygon": [[12.0, 1.0], [13.0, 1.0], [13.0, 2.0]]}]),
            "openings.0.polygon: [12, 1] is on no level (in 'o')",
        ),
        (plan_keys(walls=[wall([5.0, 5.0], [25.0, 5.0])]), "walls.0: [5, 5] to [25, 5] is not on one level"),
        (plan_keys(walls=[wall([12.0, 5.0], [14.0, 5.0])]), "walls.0: [12, 5] to [14, 5] is not on one level"),
    ],
)
def test_levels_that_cannot_be_are_one_line(keys: dict[str, Any], line: str) -> None:
    with pytest.raises(ScenarioError, match=f"^plan.yaml: {re.escape(line)}"):
        checked(FloorPlan, keys, place="plan.yaml: ")


def test_lifts_lead_from_each_stop_to_each_and_stairs_from_level_to_level() -> None:
    plan = checked(FloorPlan, plan_keys(), place="")
    found = {
        (way.passage.name, way.start[0], way.end[0]): way
        for by in ("robots", "people")
        for way in ways(plan.levels, plan.passages, by)
    }
    lift = [("lift", 2.0, 22.0), ("lift", 2.0, 42.0), ("lift", 22.0, 42.0)]
    assert list(found) == [*lift, ("stairs", 8.0, 28.0), ("stairs", 28.0, 48.0)]
    assert [found[one].length_m for one in lift] == pytest.approx([3.0, 6.0, 3.0])
    assert found["stairs", 8.0, 28.0].length_m == pytest.approx(5.0)  # 3 m up and 4 m along
    assert found["lift", 2.0, 42.0].time_s(None) == pytest.approx(4.0 + 6.0 / 2.0)
    # As long as what one goes at 2 m/s in that time.
    assert found["lift", 2.0, 42.0].equivalent_m("robots") == pytest.approx(14.0)


def test_ceiling_is_the_next_floor_by_default() -> None:
    plan = checked(FloorPlan, with_level(0, height_m=2.5), place="")
    assert [ceiling_height_m(plan.levels, level) for level in plan.levels] == [2.5, 3.0, 3.0]
