"""Puts the levels of an imported building side by side into one plan, see `scenario.levels`."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Point
from robotteamsim.scenario.floor_plan import Block, FloorPlan
from robotteamsim.scenario.materials import Material
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.shapes import MAX_SIDE_M

GAP_M = 10.0
"""Between two levels, so that no laser sees from one to the other."""

LIFT = {"kind": "lift", "radius_m": 0.5, "speed_mps": 1.0, "wait_s": 5.0}
"""Of lifts, of which files say none of this: radius of a stop, speed, and time for doors and waiting."""


@dataclass(frozen=True)
class DrawnLevel:
    """A level in the frame of its building.

    plan:     what is on it, without levels of its own.
    openings: polygons in its floor [m].
    height_m: from floor to ceiling; None: to the next floor.
    """

    name: str
    elevation_m: float
    plan: FloorPlan
    openings: Sequence[Sequence[Point]] = ()
    height_m: float | None = None


@dataclass(frozen=True)
class DrawnPassage:
    """Stairs, a ramp or a lift. stops: by the names of levels, in the frame of the building [m]."""

    keys: Mapping[str, Any]
    stops: Mapping[str, Point]


def side_by_side(
    path: Path, name: str, levels: Sequence[DrawnLevel], passages: Sequence[DrawnPassage] = ()
) -> FloorPlan:
    """Return the plan of a building: the first level where it is, the others to the right of it, as they are in y.

    Names of walls, blocks and doors begin with that of their level. Of a passage, stops on other levels are left out,
    and it itself if it has fewer than two.

    Args:   path: of the file, for errors.
    Raises: ScenarioError: the levels have no room in a plan, or two are at the same height.
    """
    for one, other in itertools.combinations(levels, 2):
        if abs(one.elevation_m - other.elevation_m) < 0.01:
            text = f"levels {one.name} and {other.name} are both at {one.elevation_m:g} m; --level imports one of them"
            raise ScenarioError(f"{path}: {text}")
    widths_m = [drawn.plan.bounds.max[0] - drawn.plan.bounds.min[0] for drawn in levels]
    if (width_m := sum(widths_m) + GAP_M * (len(levels) - 1)) > MAX_SIDE_M:
        text = f"{len(levels)} levels side by side are {width_m:.0f} m wide; expected at most {MAX_SIDE_M:g}"
        raise ScenarioError(f"{path}: {text}; --level imports one of them")
    keys: dict[str, list[Any]] = {key: [] for key in ("walls", "blocks", "doors", "levels", "openings", "passages")}
    materials: dict[str, Material] = {}
    offsets: dict[str, float] = {}
    low_m, high_m = (_moved(corner, 0.0) for corner in (levels[0].plan.bounds.min, levels[0].plan.bounds.max))
    for drawn in levels:
        plan = drawn.plan
        offset_m = round(high_m[0] + GAP_M - plan.bounds.min[0], 3) if offsets else 0.0
        offsets[drawn.name] = offset_m
        low, high = _moved(plan.bounds.min, offset_m), _moved(plan.bounds.max, offset_m)
        low_m, high_m = (low_m[0], min(low_m[1], low[1])), (high[0], max(high_m[1], high[1]))
        level = {"name": drawn.name, "bounds": {"min": low, "max": high}, "origin": (offset_m, 0.0)}
        keys["levels"].append({**level, "elevation_m": drawn.elevation_m, "height_m": drawn.height_m})
        materials |= {material.name: material for material in plan.materials}
        for key in ("walls", "blocks", "doors"):
            keys[key] += [_on_level(element, drawn.name, offset_m) for element in getattr(plan, key)]
        for number, hole in enumerate(drawn.openings, 1):
            corners = [_moved(corner, offset_m) for corner in hole]
            keys["openings"].append({"name": f"{drawn.name}_opening_{number}", "polygon": corners})
    for passage in passages:
        on = sorted((drawn for drawn in levels if drawn.name in passage.stops), key=lambda drawn: drawn.elevation_m)
        if len(on) > 1:
            stops = [_moved(passage.stops[drawn.name], offsets[drawn.name]) for drawn in on]
            keys["passages"].append({**passage.keys, "stops": stops})
    bounds = {"min": low_m, "max": high_m}
    found = {"name": name, "bounds": bounds, "materials": tuple(materials.values()), **keys}
    return checked(FloorPlan, found, place=f"{path}: ")


def _on_level(element: Any, level: str, offset_m: float) -> Any:
    """Return a wall, block or door on its level, with a name that is unique in the building."""
    name = f"{level}_{element.name}"[:MAX_NAME_CHARACTERS]
    places: dict[str, Any]
    if isinstance(element, Block):
        places = {"polygon": tuple(_moved(corner, offset_m) for corner in element.polygon)}
    else:
        places = {"start": _moved(element.start, offset_m), "end": _moved(element.end, offset_m)}
    return element.model_copy(update={"name": name, **places})


def _moved(point: Point, offset_m: float) -> Point:
    return round(point[0] + offset_m, 6), point[1]
