"""The separate parts of a plan's floor: rooms without a door, and enclosed areas."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import NamedTuple

import shapely

from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import Level, level_at
from robotteamsim.scenario.plan import obstacles
from robotteamsim.wording import counted

LEAST_M2 = 1.0
"""Smaller parts are not reported."""

_NEAR_M = 1.0
"""How far from a start the floor may begin, if the start itself is too close to a wall."""

_MOST_NAMED = 10

_EDGE_M = 0.05
"""Floor that comes so near is at the edge of the plan; an import draws a thin wall there."""

_THIN_M = 0.4
"""Floor at the edge of the plan whose mean width is smaller is outside the building."""


_SURROUNDED = 0.25
"""Floor at the edge of the plan that surrounds more than this share of its own area is outside the building."""


class FloorPart(NamedTuple):
    """A part of the floor that no door connects with the others. place: somewhere inside it [m, map]."""

    area_m2: float
    place: Point


def part_texts(parts: Sequence[FloorPart], levels: Sequence[Level] = ()) -> list[str]:
    """Return area, place and level of each part for messages; beyond _MOST_NAMED, only how many more there are."""
    texts = []
    for part in parts[:_MOST_NAMED]:
        level = level_at(levels, part.place)
        on = f" on {level.name}" if level else ""
        texts.append(f"{part.area_m2:.1f} m2 around [{part.place[0]:g}, {part.place[1]:g}]{on}")
    if num_smaller := len(parts) - len(texts):
        texts.append(counted(num_smaller, "smaller part"))
    return texts


def unreached_texts(plan: FloorPlan, parts: Sequence[FloorPart]) -> list[str]:
    """Return a line for each part to which none leads from the first one. Args: parts: those of `floor_parts`."""
    start = f"no door or passage leads from the largest part of {plan.levels[0].name}" if plan.levels else ""
    start = start or "no door leads from the largest part of the floor"
    return [f"{start} to {part}" for part in part_texts(parts[1:], plan.levels)]


def floor_parts(plan: FloorPlan, radius_m: float) -> tuple[FloorPart, ...]:
    """Return the parts of the floor between which a disc cannot move, even through open doors, the largest first.

    If there are levels, the largest part of the first level is the first. Omitted are parts below LEAST_M2, those
    outside the building, and those to which passages lead from the first.

    Args: radius_m: of the disc; areas are those that its centre can be in.
    """
    shapes = _shapes(plan, radius_m)
    joined = _joined(plan, shapes, {0})
    return tuple(_part(shape) for index, shape in enumerate(shapes) if index == 0 or index not in joined)


def parts_without(plan: FloorPlan, radius_m: float, starts: Sequence[Point]) -> tuple[FloorPart, ...]:
    """Return the parts of the floor that a disc cannot reach from any of some starts [m, map]; see `floor_parts`."""
    shapes = _shapes(plan, radius_m)
    reached = _reached(plan, shapes, starts)
    return tuple(_part(shape) for index, shape in enumerate(shapes) if index not in reached)


def places_without(
    plan: FloorPlan, radius_m: float, starts: Sequence[Point], places: Sequence[tuple[Point, float]]
) -> list[int]:
    """Return which of some places, discs of a centre [m, map] and a radius [m], a disc cannot enter from any start."""
    shapes, _ = _all_shapes(plan, radius_m)
    floor = shapely.union_all([shapes[index] for index in _reached(plan, shapes, starts)])
    return [i for i, (centre, near_m) in enumerate(places) if not shapely.dwithin(floor, shapely.Point(centre), near_m)]


def _reached(plan: FloorPlan, shapes: Sequence[shapely.Polygon], starts: Sequence[Point]) -> set[int]:
    """Return the indices of the parts of the floor in which robots start, or to which passages lead from there."""
    if not starts or not shapes:
        return set()
    _, reached = shapely.STRtree(shapes).query_nearest(shapely.points(starts), max_distance=_NEAR_M)
    return _joined(plan, shapes, set(reached.tolist()))


def _joined(plan: FloorPlan, shapes: Sequence[shapely.Polygon], reached: set[int]) -> set[int]:
    """Return the indices of these parts of the floor and of those to which passages lead from them."""
    found, size = set(reached), -1
    stops = [passage.stops for passage in plan.passages if passage.takes("robots")]
    on = [[i for i, shape in enumerate(shapes) if shape.intersects(shapely.MultiPoint(places))] for places in stops]
    while len(found) != size:
        size = len(found)
        found.update(*(parts for parts in on if not found.isdisjoint(parts)))
    return found


@functools.lru_cache(maxsize=4)  # a check needs it for places and for parts
def _all_shapes(plan: FloorPlan, radius_m: float) -> tuple[list[shapely.Polygon], shapely.Geometry]:
    """Return where the centre of a disc can be if all doors are open, see `floor_parts`; and the whole page."""
    walls = obstacles(plan.model_copy(update={"doors": ()}))
    pages = [level.bounds for level in plan.levels] or [plan.bounds]
    page = shapely.union_all([shapely.box(*bounds.min, *bounds.max) for bounds in pages])
    floor = shapely.difference(page, shapely.buffer(walls, radius_m))
    parts = [part for part in shapely.get_parts(floor) if part.area >= LEAST_M2]
    first = shapely.box(*pages[0].min, *pages[0].max)
    return sorted(parts, key=lambda part: (not first.intersects(part), -part.area, part.bounds)), page


def _shapes(plan: FloorPlan, radius_m: float) -> list[shapely.Polygon]:
    """Return the parts that are not outside the building, or the largest if all are."""
    parts, page = _all_shapes(plan, radius_m)
    at_edge = [part.distance(page.boundary) <= radius_m + _EDGE_M for part in parts]
    indoors = [part for part, is_near in zip(parts, at_edge, strict=True) if not (is_near and _is_outside(part, parts))]
    return indoors or parts[:1]


def _is_outside(part: shapely.Polygon, parts: Sequence[shapely.Polygon]) -> bool:
    """Whether a part at the edge of the plan is the floor around a building, or a strip of it."""
    if part.area < _THIN_M * part.length / 2.0:
        return True
    around = shapely.Polygon(part.exterior)
    inside_m2 = sum(other.area for other in parts if other is not part and around.contains(other))
    return bool(inside_m2 > _SURROUNDED * part.area)


def _part(shape: shapely.Polygon) -> FloorPart:
    place = shapely.point_on_surface(shape)
    return FloorPart(shape.area, (round(place.x, 3), round(place.y, 3)))
