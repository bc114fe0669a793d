"""Drawings of CAD programs (DXF) as floor plans: the lines of the chosen layers are walls, or the faces of walls."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.map_import.double_lines import solids_between
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Point
from robotteamsim.scenario.dxf_content import Content, Line, content, key, metres_per_unit, read_drawing
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.image_walls import MAX_WALL_THICKNESS_M, elements
from robotteamsim.scenario.plan import Corners, rectangle_of, strip_corners
from robotteamsim.scenario.problems import checked
from robotteamsim.wording import counted, printable

MARGIN_M = 1.0
"""Free floor around the walls."""

SHORTEST_M = 0.01
"""Shorter lines are left out."""

FLAT_M = 0.01
"""Curves become straight lines that are at most this far from them."""

SMALL_M = 1.0
"""The unit of a smaller drawing may be wrong."""

MOST_WALLS = 100_000

_MM = 0.001
"""Thickness is in whole millimetres, and corners are that exact."""

_KINK = 0.5
"""In such cells; a slanted wall has smaller ones where others meet it."""


class DxfRules(NamedTuple):
    """What of a drawing is a wall.

    layers:           whose lines are walls; upper and lower case do not matter, as in CAD programs.
    metres_per_unit:  of the drawing; None: as the file says.
    wall_thickness_m: of a line that has no width and is not the face of a wall.
    """

    layers: Collection[str]
    metres_per_unit: float | None = None
    wall_thickness_m: float = 0.1


class DxfImport(NamedTuple):
    """A plan, and notes on what is not in it and on what may be wrong."""

    plan: FloorPlan
    notes: tuple[str, ...]


def import_dxf(path: Path, rules: DxfRules) -> DxfImport:
    """Return the floor plan of a drawing, whose walls begin MARGIN_M from the lower left corner, [0, 0].

    Lines, polylines and curves of the layers are walls, those in blocks included. A polyline with a width is a wall of
    that thickness; parallel lines close to each other are the faces of one wall, see `solids_between`. Part of a block
    on layer 0 has the layer of the block reference. Invisible parts, texts and dimension lines are left out; the notes
    count everything else that is.

    Raises: ScenarioError: one line with file and what was expected, such as the layers of the drawing.
    """
    drawing = read_drawing(path)
    try:
        scale, problem = rules.metres_per_unit or metres_per_unit(path, drawing), None
    except ScenarioError as error:
        scale, problem = math.nan, error
    found = content(path, drawing, None if problem else FLAT_M / scale)
    known = {line.layer for line in found.lines}
    unknown = [layer for layer in rules.layers if key(layer) not in known]
    if unknown or not rules.layers:
        which = (
            f"layer '{printable(unknown[0])}' has no lines" if unknown else "choose the layers of walls with --layer"
        )
        raise ScenarioError(f"{path}: {which}; found {', '.join(_layer_texts(found)) or 'no lines'}")
    if problem:
        raise problem
    layers = {key(layer) for layer in rules.layers}
    lines = [line for line in found.lines if line.layer in layers]
    ends_m = np.array([line.ends for line in lines]) * scale
    if not np.isfinite(ends_m).all():
        raise ScenarioError(f"{path}: coordinates that are not finite")
    is_long = np.hypot(*(ends_m[:, 1] - ends_m[:, 0]).T) >= SHORTEST_M
    width_m, height_m = np.ptp(ends_m, axis=(0, 1)).tolist()
    unit = "$INSUNITS" if rules.metres_per_unit is None else "--metres-per-unit"
    question = f"the walls are {width_m:.3g} x {height_m:.3g} m; is {unit} wrong?"
    num_long = int(is_long.sum())
    if not 0 < num_long <= MOST_WALLS:
        text = f"{num_long} of {counted(len(lines), 'line')} are at least {SHORTEST_M:g} m long; {question}"
        raise ScenarioError(f"{path}: {text if not num_long else f'{num_long} lines; expected at most {MOST_WALLS}'}")
    widths_m = np.array([line.width for line in lines]) * scale
    plan = _plan(path, ends_m[is_long], widths_m[is_long], rules.wall_thickness_m, question)
    short = [f"{len(lines) - num_long} of {len(lines)} lines, shorter than {SHORTEST_M:g} m"] * (num_long < len(lines))
    left_out = [*short, *_others(found, layers)]
    notes = [question] if max(width_m, height_m) < SMALL_M else []
    return DxfImport(plan, (*notes, *([f"left out: {', '.join(left_out)}"] if left_out else [])))


def _layer_texts(found: Content) -> Iterator[str]:
    """Yield what each layer contains, with the size of its lines in units of the drawing."""
    on_layer: dict[str, list[Line]] = {}
    for line in found.lines:
        on_layer.setdefault(line.layer, []).append(line)
    for layer in sorted({*on_layer, *(layer for layer, _ in found.others)}):
        parts = [f"{number} {printable(kind)}" for (on, kind), number in sorted(found.others.items()) if on == layer]
        if lines := on_layer.get(layer):
            width, height = np.ptp(np.array([line.ends for line in lines]), axis=(0, 1)).tolist()
            parts = [counted(len(lines), "line"), f"{width:.5g} x {height:.5g} units", *parts]
        yield f"{printable(found.names[layer])} ({', '.join(parts)})"
    yield from map(printable, sorted(found.absent))


def _others(found: Content, layers: Collection[str]) -> Iterator[str]:
    """Yield how often what else is on some layers, and what the file refers to."""
    for (layer, kind), number in sorted(found.others.items()):
        if layer in layers:
            yield f"{number} {printable(kind)} on {printable(found.names[layer])}"
    yield from map(printable, sorted(found.absent))


def _plan(path: Path, ends_m: np.ndarray, widths_m: np.ndarray, thickness_m: float, question: str) -> FloorPlan:
    """Return a plan of lines with widths; equal lines count once.

    Args: thickness_m: of a line without a width.  question: whether the unit is wrong, if the plan is too large.
    """
    margin_m = max(MARGIN_M, 0.5 * widths_m.max())
    offset_m = ends_m.min(axis=(0, 1)) - margin_m
    ends_m = (ends_m - offset_m).round(6)
    corner = (ends_m.max(axis=(0, 1)) + margin_m).round(6).tolist()
    try:
        bounds = checked(Bounds, {"min": [0.0, 0.0], "max": corner}, place=f"{path}: bounds.")
    except ScenarioError as error:
        raise ScenarioError(f"{error}; {question}") from None
    in_order = {
        (*sorted(map(tuple, ends)), width): None for ends, width in zip(ends_m.tolist(), widths_m.tolist(), strict=True)
    }
    single = np.array([(one, other) for one, other, width in in_order if not width]).reshape(-1, 2, 2)
    try:
        solid, single = solids_between(single)
    except ValueError as error:
        raise ScenarioError(f"{path}: {error}") from None
    cells = [shapely.transform(polygon, lambda xy: xy / _MM) for polygon in solid]
    walls, blocks = elements(cells, (0.0, 0.0), (_MM, _MM), _as_wall, _KINK)
    strips = [(one, other, thickness_m) for one, other in single.round(6).tolist()]
    for one, other, width_m in (*strips, *(strip for strip in in_order if strip[2])):
        if width_m > MAX_WALL_THICKNESS_M and width_m != thickness_m:
            corners = strip_corners(one, other, width_m)
            blocks.append(Block(name=f"block_{len(blocks) + 1}", polygon=corners))
        else:
            values = {"name": f"wall_{len(walls) + 1}", "from": one, "to": other, "thickness_m": width_m}
            walls.append(checked(Wall, values, place=f"{path}: walls."))
    return FloorPlan(
        name=printable(path.stem)[:MAX_NAME_CHARACTERS],
        bounds=bounds,
        walls=tuple(walls),
        blocks=tuple(blocks),
        drawing_offset_m=tuple(offset_m.round(6).tolist()),
    )


def _as_wall(name: str, corners: Corners) -> Wall | None:
    """Return a rectangle at least twice as long as wide as a wall along its middle; None: it is not one."""
    polygon = shapely.Polygon(corners)
    around = shapely.oriented_envelope(polygon)
    rectangle = rectangle_of(tuple(map(tuple, shapely.get_coordinates(around)[:4].tolist())))
    if rectangle is None or around.area - polygon.area > _MM * polygon.length:
        return None
    length_m, thickness_m, yaw = rectangle.length_m, rectangle.width_m, rectangle.yaw
    if length_m < thickness_m:
        length_m, thickness_m, yaw = thickness_m, length_m, yaw + math.pi / 2.0
    thickness_m = round(thickness_m, 3)
    if not 0.0 < thickness_m <= MAX_WALL_THICKNESS_M or length_m < 2.0 * thickness_m:
        return None
    x, y = 0.5 * length_m * math.cos(yaw), 0.5 * length_m * math.sin(yaw)
    start: Point = (round(rectangle.x - x, 6), round(rectangle.y - y, 6))
    end: Point = (round(rectangle.x + x, 6), round(rectangle.y + y, 6))
    return Wall(name=name, start=start, end=end, thickness_m=thickness_m)
