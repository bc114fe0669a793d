"""Drawings of CAD programs (DXF, DWG) as floor plans: lines of some layers are walls, or the faces of walls."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.map_import.double_lines import solids_between
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Point
from robotteamsim.scenario.cad_content import Content, Line, read_drawing, take_apart
from robotteamsim.scenario.cad_content import metres_per_unit as named_scale
from robotteamsim.scenario.cad_layers import LayerRule, Rules, layer_texts
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.image_walls import MAX_WALL_THICKNESS_M, elements
from robotteamsim.scenario.materials import GLASS, Layer, Material
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


class CadDrawing(NamedTuple):
    """A drawing as it was read.

    path:            of its file.
    content:         its lines in units of the drawing, and what else it has.
    metres_per_unit: nan if it is unknown.
    unit:            where it is from, for messages.
    problem:         why it is unknown.
    """

    path: Path
    content: Content
    metres_per_unit: float
    unit: str
    problem: ScenarioError | None


class CadImport(NamedTuple):
    """A plan; the lines of doors in it, shape (n, 2, 2) [m]; what is left out, and what may be wrong."""

    plan: FloorPlan
    door_lines_m: np.ndarray
    notes: tuple[str, ...]


def read_cad(path: Path, metres_per_unit: float | None = None) -> CadDrawing:
    """Return the drawing of a DXF or DWG file.

    Lines, polylines and curves become straight lines, those in blocks included. Part of a block on layer 0 has the
    layer of the block reference. Invisible parts, texts and dimension lines are left out; everything else is counted.

    Args:   metres_per_unit: of the drawing; None: as the file says.
    Raises: ScenarioError: one line with file and what was expected.
    """
    drawing, found = read_drawing(path)
    unit = "$INSUNITS" if metres_per_unit is None else "--metres-per-unit"
    try:
        scale, problem = metres_per_unit or named_scale(path, drawing), None
    except ScenarioError as error:
        scale, problem = math.nan, error
    take_apart(path, drawing, None if problem else FLAT_M / scale, found)
    return CadDrawing(path, found, scale, unit, problem)


def plan_of_cad(drawing: CadDrawing, rules: Rules) -> CadImport:
    """Return the floor plan of a drawing, whose walls begin MARGIN_M from the lower left corner, [0, 0].

    The lines of walls and windows are walls. A polyline with a width is a wall of that thickness; parallel lines close
    to each other are the faces of one wall, see `solids_between`, if the rules of their layers are equal.

    Args:   rules: of the layers; those without one are ignored.
    Raises: ScenarioError: one line with file and what was expected, such as the layers of the drawing.
    """
    path, found, scale = drawing.path, drawing.content, drawing.metres_per_unit
    solid = {layer for layer, rule in rules.items() if rule.kind in ("wall", "window")}
    lines = [line for line in found.lines if line.layer in solid]
    if not lines:
        raise ScenarioError(f"{path}: no layer of walls has lines; found {_listed(found)}")
    if drawing.problem:
        raise drawing.problem
    ends_m = np.array([line.ends for line in lines]) * scale
    is_finite = np.isfinite(ends_m).all(axis=(1, 2))
    if not is_finite.all():
        layer = found.names[lines[int(np.argmin(is_finite))].layer]
        raise ScenarioError(f"{path}: layer '{printable(layer)}' has coordinates that are not finite")
    is_long = np.hypot(*(ends_m[:, 1] - ends_m[:, 0]).T) >= SHORTEST_M
    width_m, height_m = np.ptp(ends_m, axis=(0, 1)).tolist()
    question = f"the walls are {width_m:.3g} x {height_m:.3g} m; is {drawing.unit} wrong?"
    num_long = int(is_long.sum())
    if not 0 < num_long <= MOST_WALLS:
        text = f"{num_long} of {counted(len(lines), 'line')} are at least {SHORTEST_M:g} m long; {question}"
        raise ScenarioError(f"{path}: {text if not num_long else f'{num_long} lines; expected at most {MOST_WALLS}'}")
    by_rule: dict[LayerRule, list[Line]] = {}
    for index in np.flatnonzero(is_long).tolist():
        by_rule.setdefault(rules[lines[index].layer], []).append(lines[index])
    plan = _plan(path, by_rule, scale, question)
    short = [f"{len(lines) - num_long} of {len(lines)} lines, shorter than {SHORTEST_M:g} m"] * (num_long < len(lines))
    left_out = [*short, *_others(found, solid)]
    notes = [question] if max(width_m, height_m) < SMALL_M else []
    notes += [f"left out: {', '.join(left_out)}"] if left_out else []
    doors = [line.ends for line in found.lines if line.layer in rules and rules[line.layer].kind == "door"]
    return CadImport(plan, np.array(doors).reshape(-1, 2, 2) * scale - np.array(plan.drawing_offset_m), tuple(notes))


def _listed(found: Content) -> str:
    """Return the layers with what each contains, and what the file refers to."""
    layers = [f"{printable(found.names[layer])} ({text})" for layer, text in layer_texts(found).items()]
    return ", ".join([*layers, *map(printable, sorted(found.absent))]) or "no lines"


def _others(found: Content, layers: Collection[str]) -> Iterator[str]:
    """Yield how often what else is on some layers, and what the file refers to."""
    for (layer, kind), number in sorted(found.others.items()):
        if layer in layers:
            yield f"{number} {printable(kind)} on {printable(found.names[layer])}"
    yield from map(printable, sorted(found.absent))


def _plan(path: Path, by_rule: Mapping[LayerRule, Sequence[Line]], scale: float, question: str) -> FloorPlan:
    """Return a plan of lines in units of 1/`scale` m. Args: question: if the plan is too large, is the unit wrong?"""
    ends_m = {rule: np.array([line.ends for line in lines]) * scale for rule, lines in by_rule.items()}
    widths_m = {rule: np.array([line.width for line in lines]) * scale for rule, lines in by_rule.items()}
    margin_m = max(MARGIN_M, *(0.5 * widths.max() for widths in widths_m.values()))
    offset_m = np.min([ends.min(axis=(0, 1)) for ends in ends_m.values()], axis=0) - margin_m
    ends_m = {rule: (ends - offset_m).round(6) for rule, ends in ends_m.items()}
    corner = (np.max([ends.max(axis=(0, 1)) for ends in ends_m.values()], axis=0) + margin_m).round(6).tolist()
    try:
        bounds = checked(Bounds, {"min": [0.0, 0.0], "max": corner}, place=f"{path}: bounds.")
    except ScenarioError as error:
        raise ScenarioError(f"{error}; {question}") from None
    found: list[Wall | Block] = []
    materials: dict[str, Material] = {}
    numbers = Counter[str]()
    for rule, ends in ends_m.items():
        for element in _solids(path, ends, widths_m[rule], rule.thickness_m):
            noun = rule.kind if isinstance(element, Wall) else "block"
            numbers[noun] += 1
            keys = {"name": f"{noun}_{numbers[noun]}"}
            if material := _material(path, rule, element):
                materials[material.name] = material
                keys["material"] = material.name
            found.append(element.model_copy(update=keys))
    return FloorPlan(
        name=printable(path.stem)[:MAX_NAME_CHARACTERS],
        bounds=bounds,
        walls=tuple(element for element in found if isinstance(element, Wall)),
        blocks=tuple(element for element in found if isinstance(element, Block)),
        materials=tuple(materials.values()),
        drawing_offset_m=tuple(offset_m.round(6).tolist()),
    )


def _solids(path: Path, ends_m: np.ndarray, widths_m: np.ndarray, thickness_m: float) -> Iterator[Wall | Block]:
    """Yield the walls and blocks that lines with widths show; equal lines count once.

    Args: thickness_m: of a line that is not the face of a wall and has no width.
    """
    in_order = {
        (*sorted(map(tuple, ends)), width): None for ends, width in zip(ends_m.tolist(), widths_m.tolist(), strict=True)
    }
    single = np.array([(one, other) for one, other, width in in_order if not width]).reshape(-1, 2, 2)
    try:
        solid, single = solids_between(single)
    except ValueError as error:
        raise ScenarioError(f"{path}: {error}") from None
    cells = [shapely.transform(polygon, lambda xy: xy / _MM) for polygon in solid]
    for some in elements(cells, (0.0, 0.0), (_MM, _MM), _as_wall, _KINK):
        yield from some
    strips = [(one, other, thickness_m) for one, other in single.round(6).tolist()]
    for one, other, width_m in (*strips, *(strip for strip in in_order if strip[2])):
        if width_m > MAX_WALL_THICKNESS_M:
            yield Block(name="block", polygon=strip_corners(one, other, width_m))
        else:
            values = {"name": "wall", "from": one, "to": other, "thickness_m": width_m}
            yield checked(Wall, values, place=f"{path}: walls.")


def _material(path: Path, rule: LayerRule, element: Wall | Block) -> Material | None:
    """Return what an element is built of: its substance in its thickness, or a pane of glass; None: nothing says it."""
    if rule.material == "glass" or (rule.material is None and rule.kind == "window"):
        return GLASS
    if rule.material is None:
        return None
    thickness_m = element.thickness_m
    if isinstance(element, Block) and thickness_m is None:
        sides = shapely.get_coordinates(shapely.oriented_envelope(shapely.Polygon(element.polygon)))[:3]
        thickness_m = round(float(np.hypot(*np.diff(sides, axis=0).T).min()), 3)
    layer = checked(Layer, {"of": rule.material, "thickness_m": thickness_m}, place=f"{path}: {element.name}: ")
    return Material(name=f"{rule.material} {thickness_m:g} m", layers=(layer,))


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
