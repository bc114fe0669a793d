"""The building in the 3D scene: floor, walls, pillars, doors, and the boxes and barrels in it."""

import itertools
from collections.abc import Iterator, Mapping

import shapely

from robotteamsim import palette
from robotteamsim.nodes.scene.shapes import Mesh, colour, faded, label, lines, unit
from robotteamsim.recording.topics.markers import Colour, Marker, Position
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import floors, leaf_corners, level_marks, solids

FLOOR = colour(palette.DARK_FLOOR)
FLOOR_EDGE = colour(palette.DARK_FLOOR_EDGE)
WALL_EDGE = colour(palette.WALL_EDGE)

FLOOR_MARGIN_M = 1.2
NAME_M, LETTER_SHARE = 1.1, 0.52
"""Height of the name of a level in a building of 60 x 40 m, and width of a letter as a share of it."""

# Heights of what lies on the floor; far enough apart for the depth buffer of a camera 60 m away.
# The maps of rviz are at 0, above the floor.
EDGE_Z_M, FLOOR_Z_M, VOICE_Z_M, DISC_Z_M, TRAIL_Z_M = -0.05, -0.02, 0.02, 0.03, 0.05
# Its layers for `drawn_below`.
SMOKE_LAYER, TRAIL_LAYER, DISC_LAYER, VOICE_LAYER = range(4)


def building_markers(plan: FloorPlan, cut_height_m: float) -> list[Marker]:
    """Return floor, walls, blocks and pillars, cut at a height to show the robots behind them."""
    floor = Mesh()
    for bounds in floors(plan):
        inside = shapely.box(*bounds.min, *bounds.max)
        floor.polygon(inside.buffer(FLOOR_MARGIN_M, join_style="mitre"), EDGE_Z_M, FLOOR_EDGE)
        floor.polygon(inside, FLOOR_Z_M, FLOOR)
    for passage in plan.passages:
        for stop in passage.stops:
            rim_m = 0.86 * passage.radius_m
            floor.ring(stop, 0.0, rim_m, DISC_Z_M, FLOOR_EDGE)
            floor.ring(stop, rim_m, passage.radius_m, DISC_Z_M, WALL_EDGE)
    return [floor.marker("floor", 0), *_names(plan), *_wall_markers(plan, cut_height_m)]


def _names(plan: FloorPlan) -> Iterator[Marker]:
    """Yield the names of levels, in a corner of their floors, and those of passages, in their stops."""
    number, height_m = itertools.count(), NAME_M * unit(plan.bounds)
    for name, (x, y) in level_marks(plan):
        middle_m = (0.5 * LETTER_SHARE * len(name) + 0.5) * height_m
        yield label("names", next(number), name, WALL_EDGE, (x + middle_m, y + height_m, 0.6 * height_m), height_m)
    for passage in plan.passages:
        fitting_m = min(1.8 * passage.radius_m / (LETTER_SHARE * len(passage.name)), 0.8 * height_m)
        for stop in passage.stops:
            yield label("names", next(number), passage.name, WALL_EDGE, (*stop, 0.6 * fitting_m), fitting_m)


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
            tint = faded(tint, 0.6)
            if door.motion == "instant":
                leaf = shapely.affinity.rotate(leaf, 90.0, origin=door.start)
        body.prism(leaf, 0.0, min(door.height_m, cut_height_m), tint)
        if is_closed:
            threshold = shapely.LineString([door.start, door.end]).buffer(0.25, cap_style="flat")
            body.polygon(threshold, DISC_Z_M, faded(tint, 0.35))
        found.append(body.marker("doors", i))
    return found


def _wall_markers(plan: FloorPlan, cut_height_m: float) -> Iterator[Marker]:
    """Yield one mesh of all solids and their upper edges; solids of equal height and colour have no inner faces."""
    groups: dict[tuple[float, str], list[shapely.Polygon]] = {}
    for solid in solids(plan):
        if solid.kind != "door":
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
