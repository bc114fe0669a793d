"""The building in the 3D scene: floor, walls, pillars and doors."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence

import shapely
from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.ros.scene.shapes import (
    SHADOW_PER_HEIGHT,
    Colour,
    Mesh,
    Position,
    colour,
    drawn_below,
    faded,
    lines,
    mixed,
)
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.plan import Solid, leaf_corners, solids

FLOOR = colour(palette.DARK_FLOOR)
FLOOR_EDGE = colour(palette.DARK_FLOOR_EDGE)
FLOOR_LINE = colour(palette.DARK_FLOOR_LINE)
WALL_EDGE = colour(palette.WALL_EDGE)
SHADOW = colour(palette.SHADOW, 0.38)

FLOOR_MARGIN_M = 1.2
FLOOR_LINE_SPACING_M = 5.0

# Heights of what lies on the floor; far enough apart for the depth buffer of a camera 60 m away.
FLOOR_LINE_Z_M, SHADOW_Z_M, VOICE_Z_M, DISC_Z_M, TRAIL_Z_M = 0.006, 0.012, 0.02, 0.03, 0.05
# Its layers for `drawn_below`.
SMOKE_LAYER, TRAIL_LAYER, DISC_LAYER, CONTOUR_LAYER, VOICE_LAYER, SHADOW_LAYER = range(6)


def building_markers(plan: FloorPlan, cut_height_m: float) -> list[Marker]:
    """Return floor, shadows, walls, blocks and pillars, cut at a height to show the robots behind them."""
    fixed = [solid for solid in solids(plan) if solid.kind != "door"]
    return [*_floor_markers(plan.bounds), *_shadow_markers(fixed, cut_height_m), *_wall_markers(fixed, cut_height_m)]


def openings_at_start(plan: FloorPlan) -> dict[str, float]:
    """Return the initial opening of each door, by name: 0 closed, 1 open."""
    return {door.name: 0.0 if door.closed else 1.0 for door in plan.doors}


def door_markers(plan: FloorPlan, openings: Mapping[str, float], cut_height_m: float) -> list[Marker]:
    """Return one leaf per door. The open leaf of an instant door, which does not exist, is drawn at a right angle.

    Args: openings: opening of each door, by name: 0 closed .. 1 open.
    """
    found = []
    for i, door in enumerate(plan.doors):
        tint, leaf = colour(palette.LIT_DOORS[door.kind]), shapely.Polygon(leaf_corners(door, openings[door.name]))
        body, is_closed = Mesh(), openings[door.name] == 0.0
        if not is_closed:
            tint = mixed(faded(tint, 0.75), faded(FLOOR, 0.75), 0.25)
            if door.motion == "instant":
                leaf = shapely.affinity.rotate(leaf, 90.0, origin=door.start)
        body.prism(leaf, 0.0, min(door.height_m, cut_height_m), tint)
        if is_closed:
            threshold = shapely.LineString([door.start, door.end]).buffer(0.25, cap_style="flat")
            body.polygon(threshold, DISC_Z_M, faded(tint, 0.35))
        found.append(body.marker("doors", i))
    return found


def _floor_markers(bounds: Bounds) -> Iterator[Marker]:
    (min_x, min_y), (max_x, max_y) = bounds.min, bounds.max
    inside, floor = shapely.box(min_x, min_y, max_x, max_y), Mesh()
    floor.polygon(inside.buffer(FLOOR_MARGIN_M, join_style="mitre"), -0.03, FLOOR_EDGE)
    floor.polygon(inside, 0.0, FLOOR)
    yield floor.marker("floor", 0)

    def grid() -> Iterator[tuple[Position, Position, Colour]]:
        for x in _multiples(FLOOR_LINE_SPACING_M, min_x, max_x):
            yield (x, min_y, FLOOR_LINE_Z_M), (x, max_y, FLOOR_LINE_Z_M), FLOOR_LINE
        for y in _multiples(FLOOR_LINE_SPACING_M, min_y, max_y):
            yield (min_x, y, FLOOR_LINE_Z_M), (max_x, y, FLOOR_LINE_Z_M), FLOOR_LINE

    yield lines("floor", 1, grid(), 0.04)


def _multiples(spacing: float, low: float, high: float) -> list[float]:
    return [i * spacing for i in range(math.floor(low / spacing) + 1, math.ceil(high / spacing))]


def _shadow_markers(fixed: Sequence[Solid], cut_height_m: float) -> Iterator[Marker]:
    """Yield the shadows of the walls: the floor that each edge sweeps along the light."""
    cast = []
    for solid in fixed:
        x, y = (min(solid.element.height_m, cut_height_m) * offset for offset in SHADOW_PER_HEIGHT)
        edges = itertools.pairwise(solid.polygon.exterior.coords)
        cast += [
            shapely.MultiPoint([(x0, y0), (x1, y1), (x1 + x, y1 + y), (x0 + x, y0 + y)]).convex_hull
            for (x0, y0), (x1, y1) in edges
        ]
        cast.append(shapely.affinity.translate(solid.polygon, x, y))
    dark = shapely.difference(shapely.union_all(cast), shapely.union_all([solid.polygon for solid in fixed]))
    if not dark.is_empty:
        shade = Mesh()
        shade.polygon(dark, SHADOW_Z_M, SHADOW)
        yield drawn_below(shade.marker("shadows", 0), SHADOW_LAYER)


def _wall_markers(fixed: Sequence[Solid], cut_height_m: float) -> Iterator[Marker]:
    """Yield one mesh of all solids and their upper edges; solids of equal height and colour have no inner faces."""
    groups: dict[tuple[float, str], list[shapely.Polygon]] = {}
    for solid in fixed:
        groups.setdefault((min(solid.element.height_m, cut_height_m), solid.kind), []).append(solid.polygon)
    body, edges = Mesh(), list[tuple[Position, Position, Colour]]()
    for (height_m, kind), outlines in groups.items():
        shape = shapely.union_all(outlines)
        body.prism(shape, 0.0, height_m, colour(palette.LIT_SOLIDS[kind]))
        for loop in shapely.get_parts(shapely.boundary(shape)):
            rim = [(x, y, height_m + 0.005) for x, y in loop.coords]
            edges += [(start, end, WALL_EDGE) for start, end in itertools.pairwise(rim)]
    if edges:
        yield body.marker("walls", 0)
        yield lines("walls", 1, edges, 0.05)
