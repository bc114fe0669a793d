"""The building in the 3D scene: floor, walls, pillars and doors."""

import itertools
import math
from collections.abc import Iterator, Mapping

import shapely
from shapely.geometry.polygon import orient
from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.msg import MissionEvent
from robotteamsim.ros.scene.shapes import (
    SHADOW_LAYER,
    Colour,
    Mesh,
    Position,
    colour,
    drawn_below,
    faded,
    lines,
    mixed,
    shaded,
)
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import Solid, leaf_corners, solids

FLOOR = colour(palette.DARK_FLOOR)
FLOOR_EDGE = colour(palette.DARK_FLOOR_EDGE)
FLOOR_LINE = colour(palette.DARK_FLOOR_LINE)
WALL_EDGE = colour(palette.WALL_EDGE)
SHADOW = colour(palette.SHADOW, 0.38)

FLOOR_MARGIN_M = 1.2
FLOOR_LINE_SPACING_M = 5.0
SHADOW_PER_HEIGHT = (0.55, -0.45)
"""Offset of the shadow of a point 1 m above the floor [m, m]: the sun is in the north-west."""

_SUN_AZIMUTH_RAD = math.atan2(-SHADOW_PER_HEIGHT[1], -SHADOW_PER_HEIGHT[0])

# Heights of layers near the floor; far enough apart for the depth buffer of a camera 60 m away.
FLOOR_Z_M = 0.0
FLOOR_LINE_Z_M = 0.006
SHADOW_Z_M = 0.012
VOICE_Z_M = 0.02
AREA_Z_M = 0.03
TRAIL_Z_M = 0.05


def building_markers(plan: FloorPlan, cut_height_m: float) -> list[Marker]:
    """Return floor, shadows, walls, blocks and pillars; taller ones are cut at `cut_height_m`.

    The cut lets a viewer see robots behind walls from above; `door_markers` draws doors.
    """
    fixed = [solid for solid in solids(plan) if solid.kind != "door"]
    return [
        *_floor_markers(plan),
        *_shadow_markers(fixed, cut_height_m),
        *_wall_markers(fixed, cut_height_m),
    ]


def openings_at_start(plan: FloorPlan) -> dict[str, float]:
    """Return the initial opening of each door, by name: 0 closed, 1 open."""
    return {door.name: 0.0 if door.closed else 1.0 for door in plan.doors}


def door_markers(plan: FloorPlan, openings: Mapping[str, float], cut_height_m: float) -> list[Marker]:
    """Return one leaf per door. The open leaf of an instant door, which does not exist, is drawn at a right angle.

    Args: openings: opening of each door, by name: 0 closed .. 1 open.
    """
    return [_door_marker(i, door, openings[door.name], cut_height_m) for i, door in enumerate(plan.doors)]


def door_change(event: MissionEvent) -> tuple[str, float] | None:
    """Return name and opening of a door if an event reports that it was opened or closed; else None."""
    return (event.subject, 0.0 if event.detail.endswith("closed") else 1.0) if event.kind == "door" else None


def _floor_markers(plan: FloorPlan) -> Iterator[Marker]:
    (min_x, min_y), (max_x, max_y) = plan.bounds.min, plan.bounds.max
    floor = Mesh()
    margin = FLOOR_MARGIN_M
    floor.polygon(shapely.box(min_x - margin, min_y - margin, max_x + margin, max_y + margin), -0.03, FLOOR_EDGE)
    floor.polygon(shapely.box(min_x, min_y, max_x, max_y), FLOOR_Z_M, FLOOR)
    yield floor.marker("floor", 0)

    def grid() -> Iterator[tuple[Position, Position, Colour]]:
        for x in _multiples(FLOOR_LINE_SPACING_M, min_x, max_x):
            yield (x, min_y, FLOOR_LINE_Z_M), (x, max_y, FLOOR_LINE_Z_M), FLOOR_LINE
        for y in _multiples(FLOOR_LINE_SPACING_M, min_y, max_y):
            yield (min_x, y, FLOOR_LINE_Z_M), (max_x, y, FLOOR_LINE_Z_M), FLOOR_LINE

    yield lines("floor", 1, grid(), 0.04)


def _multiples(spacing: float, low: float, high: float) -> list[float]:
    return [i * spacing for i in range(math.floor(low / spacing) + 1, math.ceil(high / spacing))]


def _shadow_markers(fixed: list[Solid], cut_height_m: float) -> Iterator[Marker]:
    """Yield the shadows of the walls: the floor swept by every edge along the light."""
    cast = []
    for solid in fixed:
        height_m = min(solid.element.height_m, cut_height_m)
        moved = shapely.affinity.translate(solid.polygon, *(part * height_m for part in SHADOW_PER_HEIGHT))
        corners, ends = solid.polygon.exterior.coords, moved.exterior.coords
        sides = [
            shapely.Polygon([corners[i], corners[i + 1], ends[i + 1], ends[i]]).buffer(0)
            for i in range(len(corners) - 1)
        ]
        cast += [moved, *sides]
    ground = shapely.union_all([solid.polygon for solid in fixed])
    dark = shapely.difference(shapely.union_all(cast), ground)
    if not dark.is_empty:
        shade = Mesh()
        for part in _polygons(dark):
            shade.polygon(part, SHADOW_Z_M, SHADOW)
        yield drawn_below(shade.marker("shadows", 0), SHADOW_LAYER)


def _wall_markers(fixed: list[Solid], cut_height_m: float) -> Iterator[Marker]:
    """Yield one mesh of all solids and their upper edges; solids of equal height and colour have no inner faces."""
    groups: dict[tuple[float, str], list[shapely.Polygon]] = {}
    for solid in fixed:
        height_m = min(solid.element.height_m, cut_height_m)
        groups.setdefault((height_m, solid.kind), []).append(solid.polygon)
    body, edges = Mesh(), []
    for (height_m, kind), outlines in groups.items():
        tint = colour(palette.LIT_SOLIDS[kind])
        for part in _polygons(shapely.union_all(outlines)):
            body.polygon(part, height_m, tint)
            for loop in (part.exterior, *part.interiors):
                _add_sides(body, list(loop.coords), height_m, tint)
                ring = [(x, y, height_m + 0.005) for x, y in loop.coords]
                edges += [(a, b, WALL_EDGE) for a, b in itertools.pairwise(ring)]
    if len(body):
        yield body.marker("walls", 0)
        yield lines("walls", 1, edges, 0.05)


def _polygons(shape: shapely.Geometry) -> list[shapely.Polygon]:
    """Return the parts of a union, oriented with their inside to the left of every outline."""
    return [orient(part) for part in shapely.get_parts(shape) if part.geom_type == "Polygon"]


def _add_sides(body: Mesh, loop: list[tuple[float, float]], height_m: float, tint: Colour) -> None:
    """Add the vertical faces over an outline with its inside to the left: bright towards the sun, darker below."""
    for (x0, y0), (x1, y1) in itertools.pairwise(loop):
        facing_rad = math.atan2(y1 - y0, x1 - x0) - math.pi / 2.0
        light = 0.62 + 0.2 * math.cos(facing_rad - _SUN_AZIMUTH_RAD)
        high, low = shaded(tint, light), shaded(tint, 0.62 * light)
        body.quad([(x0, y0, 0.0), (x1, y1, 0.0), (x1, y1, height_m), (x0, y0, height_m)], [low, low, high, high])


def _door_marker(marker_id: int, door: Door, opening: float, cut_height_m: float) -> Marker:
    closed = opening == 0.0
    tint = colour(palette.LIT_DOORS[door.kind])
    leaf = shapely.Polygon(leaf_corners(door, opening))
    if not closed:
        if door.motion == "instant":
            leaf = shapely.affinity.rotate(leaf, 90.0, origin=door.start)
        tint = mixed(faded(tint, 0.75), faded(FLOOR, 0.75), 0.25)
    height_m = min(door.height_m, cut_height_m)
    body = Mesh()
    body.polygon(leaf, height_m, tint)
    _add_sides(body, list(leaf.exterior.coords), height_m, tint)
    if closed:
        threshold = shapely.LineString([door.start, door.end]).buffer(0.25, cap_style="flat")
        body.polygon(threshold, AREA_Z_M, faded(tint, 0.35))
    return body.marker("doors", marker_id)
