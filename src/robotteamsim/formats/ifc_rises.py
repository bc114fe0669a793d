"""Stairs, ramps and lifts of an IFC building as passages between its storeys, and the holes in floors above them."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from robotteamsim.formats.ifc_file import IfcBuilding, Rise
from robotteamsim.formats.ifc_shapes import FLAT_M, Mesh, clipped, footprint, outlines
from robotteamsim.formats.ifc_storey import CLOSE_M, FLOOR_M, PASSABLE_M, STEP_M
from robotteamsim.formats.side_by_side import LIFT, DrawnLevel, DrawnPassage
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.plan import obstacles
from robotteamsim.wording import counted

RAILING_M = 1.3
"""Stairs whose railings are part of them end at most so far above the floor to which they lead."""

_BAND_M, _EVEN_M = 0.2, 0.02
"""Steps are looked for in bands of that height; and what is so far above a floor is level with it."""

_LEAST_SLOPE, _LEAST_STEP_M2, _LANDING_M = 0.5, 0.05, 0.7
"""Least upward component of the normal of a step; its least area, and the least side of a landing."""

_AHEAD_M = 0.1
"""Least distance between the steps that give the direction in which stairs begin or end."""

_STOP_M = 0.5
_BEFORE_M = (_STOP_M, 0.4, 0.3, 0.25, 0.0)
"""How far a stop may be from the first or last step; the first place that is free counts."""

_HOLE_M2 = 0.25
_HIGHEST_M = 200.0
"""Of stairs."""


class _Step(NamedTuple):
    """What one can step on within a band of heights. centre: shape (3,).  corners: shape (n, 2) [m]."""

    area_m2: float
    centre: np.ndarray
    corners: np.ndarray


class _Floors:
    """The storeys that were drawn, from the lowest up, and where on them a robot can stand."""

    def __init__(self, levels: Sequence[DrawnLevel], robot_m: float) -> None:
        self.levels = sorted(levels, key=lambda level: level.elevation_m)
        self.heights_m = np.array([level.elevation_m for level in self.levels])
        self._robot_m = robot_m
        self._solids = [obstacles(level.plan.model_copy(update={"doors": ()})) for level in self.levels]

    def is_free(self, index: int, place: np.ndarray, edge: np.ndarray) -> bool:
        """Whether a robot can stand at a place, with nothing between it and the edge of a step."""
        point, bounds = shapely.Point(place), self.levels[index].plan.bounds
        inside = all(
            low + self._robot_m <= at <= high - self._robot_m
            for low, at, high in zip(bounds.min, place, bounds.max, strict=True)
        )
        if not inside or shapely.dwithin(self._solids[index], point, self._robot_m):
            return False
        begin = edge + min(1.0, CLOSE_M / max(math.dist(edge, place), CLOSE_M)) * (place - edge)
        return not shapely.LineString([begin, place]).intersects(self._solids[index])

    def stop(self, index: int, edge: np.ndarray, outwards: np.ndarray) -> Point | None:
        """Return a free place before a step; None: there is none."""
        places = (edge + before_m * outwards for before_m in _BEFORE_M)
        found = next((place for place in places if self.is_free(index, place, edge)), None)
        return None if found is None else _point(found)


class Joined(NamedTuple):
    """Storeys with the holes in their floors, the passages between them, and one line on each that joins nothing."""

    levels: list[DrawnLevel]
    passages: list[DrawnPassage]
    notes: list[str]


def joined(building: IfcBuilding, levels: Sequence[DrawnLevel], robot_m: float) -> Joined:
    """Return the storeys of a building joined by its stairs, ramps and lifts.

    Args: robot_m: radius of the robot that can stand at their stops.
    """
    floors = _Floors(levels, robot_m)
    passages: list[DrawnPassage] = []
    notes: list[str] = []
    holes: dict[str, list[Sequence[Point]]] = {level.name: [] for level in levels}
    for rise in building.rises:
        found: DrawnPassage | str = "it has no shape that can be read"
        if rise.meshes:
            found = _lift(rise, floors) if rise.kind == "lift" else _stairs(rise, floors)
        if isinstance(found, str):
            notes.append(f"{rise.text}: joins no storeys; {found}")
            continue
        passages.append(found)
        on = [level for level in floors.levels if level.name in found.stops]
        for below, above in itertools.pairwise(on):
            bounds = shapely.box(*above.plan.bounds.min, *above.plan.bounds.max)
            holes[above.name] += _holes(building, rise, below.elevation_m, above.elevation_m, bounds)
    with_holes = [dataclasses.replace(level, openings=holes[level.name]) for level in levels]
    return Joined(with_holes, passages, notes)


def rises_at(building: IfcBuilding, floor_m: float) -> list[Rise]:
    """Return the stairs, ramps and lifts at which one may stand on a floor."""
    found = []
    for rise in filter(lambda one: one.meshes, building.rises):
        low_m, high_m = _heights_m(rise)
        found += [rise] if low_m - STEP_M <= floor_m <= high_m + STEP_M else []
    return found


def _lift(rise: Rise, floors: _Floors) -> DrawnPassage | str:
    """Return a lift with a stop in the middle of its shaft on each storey that it passes, or why it joins nothing."""
    low_m, high_m = _heights_m(rise)
    corners = np.concatenate([mesh.corners.reshape(-1, 3) for mesh in rise.meshes])[:, :2]
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    passed = (floors.heights_m >= low_m - STEP_M) & (floors.heights_m <= high_m - PASSABLE_M)
    free = {
        floors.levels[i].name: _point(middle)
        for i in np.flatnonzero(passed).tolist()
        if floors.is_free(i, middle, middle)
    }
    if len(free) < 2:
        return f"its shape, from {low_m:.2f} to {high_m:.2f} m, is free on {counted(len(free), 'storey')}"
    return DrawnPassage({"name": f"lift_{rise.element.id()}", **LIFT}, free)


def _stairs(rise: Rise, floors: _Floors) -> DrawnPassage | str:
    """Return stairs or a ramp from floor to floor, or why they join nothing."""
    low_m, high_m = _heights_m(rise)
    if high_m - low_m > _HIGHEST_M:
        return f"it is {high_m - low_m:g} m high; expected at most {_HIGHEST_M:g}"
    steps = _steps(rise.meshes, low_m, high_m)
    if len(steps) < 2:
        return "it has no steps"
    low_m, high_m = float(steps[0].centre[2]), float(steps[-1].centre[2])
    first = int(np.argmin(np.abs(floors.heights_m - low_m)))
    if abs(floors.heights_m[first] - low_m) > STEP_M:
        return f"it begins at {low_m:.2f} m, where no floor is"
    above = [i for i in range(first + 1, len(floors.levels)) if floors.heights_m[i] <= high_m + STEP_M]
    if not above or floors.heights_m[above[-1]] < high_m - RAILING_M:
        return f"it ends at {high_m:.2f} m, where no floor is"
    landings = {i: landing for i in above if (landing := _landing(rise, floors.heights_m[i]))}
    on = [first, *(i for i in above if i in landings or i == above[-1])]
    stops, lengths_m = {}, []
    edge: np.ndarray | None = None
    for begin, end in itertools.pairwise(on):
        begin_m, end_m = floors.heights_m[begin], floors.heights_m[end]
        steps = _steps(rise.meshes, begin_m + _EVEN_M, end_m + _EVEN_M)
        if len(steps) < 2:
            return f"it has no steps between {begin_m:g} and {end_m:g} m"
        if edge is None:
            edge, outwards = _edge(steps)
            stops[begin] = floors.stop(begin, edge, outwards)
        path = [(*edge, begin_m), *(step.centre for step in steps)]
        edge, outwards = _edge(steps[::-1])
        if end in landings:  # which one may leave to any side
            edge, outwards = landings[end].centre[:2], np.zeros(2)
        stops[end] = floors.stop(end, edge, outwards)
        lengths_m.append(np.linalg.norm(np.diff([*path, (*edge, end_m)], axis=0), axis=1).sum())
    free = {floors.levels[i].name: stop for i, stop in stops.items() if stop is not None}
    if len(free) < len(stops):
        without = next(floors.levels[i].name for i, stop in stops.items() if stop is None)
        return f"there is no free floor at its end on {without}"
    keys = {"name": f"{rise.kind}_{rise.element.id()}", "kind": rise.kind, "radius_m": _STOP_M}
    return DrawnPassage({**keys, "length_m": round(float(np.mean(lengths_m)), 3)}, free)


def _landing(rise: Rise, floor_m: float) -> _Step | None:
    """Return a landing of stairs that is level with a floor; None: there is none."""
    for step in _steps(rise.meshes, floor_m - FLOOR_M, floor_m + FLOOR_M):
        around = shapely.oriented_envelope(shapely.MultiPoint(step.corners))
        if not around.buffer(-0.5 * _LANDING_M + FLAT_M).is_empty:
            return step
    return None


def _edge(steps: Sequence[_Step]) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle of the outer edge of the first step, and the direction outwards; each float64, shape (2,)."""
    centre = steps[0].centre[:2]
    towards = (centre - step.centre[:2] for step in steps[1:])
    along = next((one for one in towards if math.hypot(*one) >= _AHEAD_M), np.array([1.0, 0.0]))
    outwards = along / math.hypot(*along)
    return centre + float(((steps[0].corners - centre) @ outwards).max()) * outwards, outwards


def _steps(meshes: Sequence[Mesh], low_m: float, high_m: float) -> list[_Step]:
    """Return what one can step on between two heights, in bands of some _BAND_M, from the lowest up."""
    corners = np.concatenate([_upper(mesh.corners[mesh.items == item]) for mesh in meshes for item in set(mesh.items)])
    edges_m = np.linspace(low_m, high_m, math.ceil((high_m - low_m) / _BAND_M) + 1)
    # Rounded: an even step is in one band as a whole.
    heights_m = corners[..., 2].round(3)
    steps = []
    for begin_m, end_m in itertools.pairwise(edges_m):
        triangles = []
        for triangle in corners[(heights_m.max(axis=1) > begin_m) & (heights_m.min(axis=1) <= end_m)]:
            part = clipped(triangle, begin_m - FLAT_M, end_m + FLAT_M)
            triangles += [(part[0], part[i], part[i + 1]) for i in range(1, len(part) - 1)]
        if not triangles:
            continue
        faces = np.array(triangles)
        sides = faces[:, 1:, :2] - faces[:, :1, :2]
        areas_m2 = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
        if (area_m2 := float(areas_m2.sum())) >= _LEAST_STEP_M2:
            centre = areas_m2 @ faces.mean(axis=1) / area_m2
            steps.append(_Step(area_m2, centre, faces[..., :2].reshape(-1, 2)))
    return steps


def _upper(corners: np.ndarray) -> np.ndarray:
    """Return the triangles of a part of a solid that face upwards; if its volume is negative, all are turned."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    volume = np.sum((corners[:, 0] - corners.mean(axis=(0, 1))) * normals)
    upward = normals[:, 2] * (1.0 if volume >= 0.0 else -1.0)
    faces: np.ndarray = corners[upward > _LEAST_SLOPE * np.linalg.norm(normals, axis=1)]
    return faces


def _heights_m(rise: Rise) -> tuple[float, float]:
    return min(mesh.low_m for mesh in rise.meshes), max(mesh.high_m for mesh in rise.meshes)


def _holes(
    building: IfcBuilding, rise: Rise, below_m: float, above_m: float, bounds: shapely.Polygon
) -> Iterator[Sequence[Point]]:
    """Yield what no slab of the upper floor covers of stairs or a shaft; nothing if there is no slab.

    Args: bounds: of the upper floor.
    """
    slabs = []
    for id_, mesh in building.slabs.items():
        cut = [hole.mesh for hole in building.openings if hole.owner == id_ and hole.mesh is not None]
        around = (above_m - STEP_M, above_m + FLOOR_M)
        holes = shapely.union_all([part for one in cut for part in footprint(one, *around)])
        slabs += [part.difference(holes) for part in footprint(mesh, *around)]
    if not slabs:
        return
    outline = shapely.union_all([part for mesh in rise.meshes for part in footprint(mesh, below_m, above_m)])
    free = outline.intersection(bounds).difference(shapely.union_all(slabs))
    wide = free.buffer(-CLOSE_M, join_style="mitre").buffer(CLOSE_M, join_style="mitre")
    yield from (corners for corners, area_m2 in outlines(wide) if area_m2 >= _HOLE_M2)


def _point(place: np.ndarray) -> Point:
    x, y = place.round(6).tolist()
    return x, y
