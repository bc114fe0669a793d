"""Drawings of CAD programs (DXF) as floor plans: each straight line of the chosen layers is a wall.

The package ezdxf is imported where it is used, because it belongs to an extra.
"""

from __future__ import annotations

import configparser
import itertools
import logging
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.yaml_text import is_file
from robotteamsim.wording import counted, printable

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.entities import DXFEntity

logging.getLogger("ezdxf").addHandler(logging.NullHandler())  # else Python prints what it repairs

MARGIN_M = 1.0
"""Free floor around the walls."""

SHORTEST_M = 0.01
"""Shorter lines are left out."""

FLAT_M = 0.01
"""Curves become straight lines that are at most this far from them."""

LEAST_SHARE = 1e-5
"""Of the size of a curve: its straight lines are not closer to it."""

LARGEST = 1e15
"""Of curves, in units of the drawing."""

MOST_BYTES = 64 * 2**20
"""Of a file: twice that of MOST_LINES lines. It needs some ten times its size while it is read."""

MOST_WALLS = 100_000

MOST_LINES = 200_000
"""Of all layers together; blocks may repeat lines without an end."""

_LINES = frozenset(("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"))
_NO_PARTS = frozenset(("DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION", "LEADER", "MULTILEADER", "HATCH"))
"""Are not taken apart: dimension lines and hatches are no walls."""


class DxfRules(NamedTuple):
    """What of a drawing is a wall.

    layers:           whose lines are walls.
    metres_per_unit:  of the drawing; None: as the file says.
    wall_thickness_m: of each line.
    """

    layers: Collection[str]
    metres_per_unit: float | None = None
    wall_thickness_m: float = 0.1


def import_dxf(path: Path, rules: DxfRules) -> FloorPlan:
    """Return the floor plan of a drawing, whose walls begin MARGIN_M from the lower left corner, [0, 0].

    Lines, polylines and curves of the layers are walls, those in blocks included; text, dimension lines and hatches are
    not. Part of a block on layer 0 has the layer of the block.

    Raises: ScenarioError: one line with file and what was expected, such as the layers of the drawing.
    """
    drawing = _read(path)
    scale = rules.metres_per_unit or _metres_per_unit(path, drawing)
    found = _found(path, drawing, FLAT_M / scale)
    layers = Counter(layer for layer, _ in found)
    unknown = [layer for layer in rules.layers if layer not in layers]
    if unknown or not rules.layers:
        known = ", ".join(f"{printable(name)} ({counted(count, 'line')})" for name, count in sorted(layers.items()))
        which = (
            f"layer '{printable(unknown[0])}' has no lines" if unknown else "choose the layers of walls with --layer"
        )
        raise ScenarioError(f"{path}: {which}; found {known or 'no lines'}")
    lines = np.array([line for layer, line in found if layer in rules.layers]) * scale
    lines = lines[np.hypot(*(lines[:, 1] - lines[:, 0]).T) >= SHORTEST_M]
    if not 0 < len(lines) <= MOST_WALLS:
        raise ScenarioError(f"{path}: {len(lines)} lines of at least {SHORTEST_M:g} m; expected 1 to {MOST_WALLS}")
    if not np.isfinite(lines).all():
        raise ScenarioError(f"{path}: coordinates that are not finite")
    lines = (lines - lines.min(axis=(0, 1)) + MARGIN_M).round(6)
    return _plan(path, lines, rules.wall_thickness_m)


def _plan(path: Path, lines: np.ndarray, thickness_m: float) -> FloorPlan:
    """Return a plan with a wall along each line [m]; equal lines count once."""
    corner = (lines.max(axis=(0, 1)) + MARGIN_M).round(6).tolist()
    bounds = checked(Bounds, {"min": [0.0, 0.0], "max": corner}, place=f"{path}: bounds.")
    ends = dict.fromkeys((min(one, other), max(one, other)) for one, other in map(_ends, lines.tolist()))
    walls = [
        checked(
            Wall,
            {"name": f"wall_{number}", "from": one, "to": other, "thickness_m": thickness_m},
            place=f"{path}: walls.",
        )
        for number, (one, other) in enumerate(ends, 1)
    ]
    return FloorPlan(name=printable(path.stem)[:MAX_NAME_CHARACTERS], bounds=bounds, walls=tuple(walls))


def _ends(line: list[list[float]]) -> tuple[tuple[float, float], tuple[float, float]]:
    (x0, y0), (x1, y1) = line
    return (x0, y0), (x1, y1)


def _read(path: Path) -> Drawing:
    """Return a drawing. Raises: ScenarioError: it cannot be read."""
    try:
        import ezdxf
    except (configparser.Error, UnicodeDecodeError) as error:
        raise ScenarioError(f"ezdxf: its configuration is damaged: {printable(' '.join(str(error).split()))}") from None
    if not is_file(path):
        raise ScenarioError(f"{path}: there is no such file")
    if path.stat().st_size > MOST_BYTES:
        raise ScenarioError(f"{path}: larger than {MOST_BYTES // 2**20} MiB; expected a drawing of one floor")
    try:
        return ezdxf.readfile(path)
    except MemoryError:
        pass  # so that what was read is freed first
    except Exception as error:  # damaged files cause IndexError, KeyError, StopIteration and others
        raise _unreadable(path, error) from None
    raise ScenarioError(f"{path}: cannot be read as DXF: out of memory")


def _unreadable(path: Path, error: Exception) -> ScenarioError:
    """Return the line for an error of ezdxf; those of Python mean nothing to the user."""
    from ezdxf import DXFError

    reason = "it is damaged"
    if isinstance(error, DXFError):
        reason = " ".join(str(error).split()).removeprefix("DXFStructureError: ").rstrip(".") or reason
    elif isinstance(error, OSError):  # also those that have no number, of ezdxf
        reason = error.strerror or "it is not a DXF file"
    elif isinstance(error, RecursionError):
        reason = "a block contains itself"
    elif isinstance(error, MemoryError):
        reason = "out of memory"
    return ScenarioError(f"{path}: cannot be read as DXF: {printable(reason)}")


def _metres_per_unit(path: Path, drawing: Drawing) -> float:
    """Return the scale that a file names. Raises: ScenarioError: it names none."""
    from ezdxf.enums import InsertUnits
    from ezdxf.units import conversion_factor

    try:
        unit = InsertUnits(drawing.units)
    except ValueError:
        unit = InsertUnits.Unitless
    if unit == InsertUnits.Unitless:
        text = f"names no known unit ($INSUNITS {drawing.units}); give its scale with --metres-per-unit"
        raise ScenarioError(f"{path}: {text}")
    try:
        return conversion_factor(unit, InsertUnits.Meters)
    except TypeError:  # ezdxf converts only some, without the feet of surveyors
        text = f"has a unit that cannot be converted ($INSUNITS {drawing.units}); give its scale with --metres-per-unit"
        raise ScenarioError(f"{path}: {text}") from None


def _found(path: Path, drawing: Drawing, flat: float) -> list[tuple[str, np.ndarray]]:
    """Return what `_lines` yields. Raises: ScenarioError: it cannot be read, or there are too many."""
    try:
        if _num_parts(drawing) > MOST_LINES:
            raise ScenarioError(f"{path}: more than {MOST_LINES} lines and other parts, with those of repeated blocks")
        found = list(itertools.islice(_lines(drawing, flat), MOST_LINES + 1))
    except ScenarioError:
        raise
    except Exception as error:  # a block that contains itself, and what the file says wrongly
        raise _unreadable(path, error) from None
    if len(found) > MOST_LINES:
        raise ScenarioError(f"{path}: more than {MOST_LINES} lines")
    return found


def _num_parts(drawing: Drawing) -> int:
    """Return into how many parts blocks would be taken apart, which may be far more than the file has."""
    known: dict[str, int] = {}

    def of_block(name: str) -> int:
        if name not in known:
            block = drawing.blocks.get(name)
            known[name] = 0 if block is None else of_entities(block)
        return known[name]

    def of_entities(entities: Iterable[DXFEntity]) -> int:
        count = 0
        for entity in entities:
            count += (1 + of_block(entity.dxf.name)) * entity.mcount if isinstance(entity, Insert) else 1
        return count

    from ezdxf.entities import Insert

    return of_entities(drawing.modelspace())


def _flat(part: DXFEntity, flat: float) -> float:
    """Return how far lines may be from a curve: not less than a share of its size, so that they are not too many.

    Raises: DXFValueError: numbers of that size cannot be divided into lines.
    """
    from ezdxf import DXFValueError, bbox

    if part.dxftype() == "LINE":
        return flat
    box = bbox.extents([part], fast=True)
    if not box.has_data:  # without points
        return flat
    size = max(box.size.x, box.size.y)
    if not size <= LARGEST:
        raise DXFValueError(f"a {part.dxftype()} has a size of {size:g}")
    return float(max(flat, LEAST_SHARE * size))


def _lines(drawing: Drawing, flat: float) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the layer and the ends of each straight line, float64, shape (2, 2), in the units of the drawing."""
    from ezdxf import disassemble

    for entity in drawing.modelspace():
        if entity.dxftype() in _NO_PARTS:
            continue
        for part in disassemble.recursive_decompose([entity]):
            if part.dxftype() not in _LINES:
                continue
            layer = entity.dxf.layer if part.dxf.layer == "0" else part.dxf.layer
            points = [(point.x, point.y) for point in disassemble.make_primitive(part, _flat(part, flat)).vertices()]
            for one, other in itertools.pairwise(points):
                yield str(layer), np.array([one, other])
