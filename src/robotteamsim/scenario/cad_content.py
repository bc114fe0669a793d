"""What a drawing of a CAD program (DXF, DWG) contains: straight lines by layer, and how often other things.

The package ezdxf is imported where it is used, because it belongs to an extra.
"""

from __future__ import annotations

import configparser
import itertools
import logging
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.dwg import read_dwg
from robotteamsim.scenario.yaml_text import is_file
from robotteamsim.wording import counted, printable

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.entities import DXFEntity, Insert

logging.getLogger("ezdxf").addHandler(logging.NullHandler())  # else Python prints what it repairs

LEAST_SHARE = 1e-5
"""Of the size of a curve: its straight lines are not closer to it."""

COARSE_SHARE = 0.01
"""The same where the unit is unknown."""

LARGEST = 1e15
"""Of curves, in units of the drawing."""

MOST_BYTES = 64 * 2**20
"""Of a file: twice that of MOST_LINES lines. It needs some ten times its size while it is read."""

MOST_LINES = 200_000
"""Of all layers together; blocks may repeat lines without an end."""

_CURVES = frozenset(("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE"))

_DIMENSIONS = "DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION", "LEADER", "MULTILEADER", "TOLERANCE"
_TEXTS = frozenset((*_DIMENSIONS, "TEXT", "MTEXT", "ATTRIB", "ATTDEF", "POINT"))
"""Are neither taken apart nor counted: texts and dimension lines are no walls."""


class Line(NamedTuple):
    """A straight line in units of the drawing: float64, shape (2, 2); width: 0 if it has none."""

    layer: str
    ends: np.ndarray
    width: float


class Content(NamedTuple):
    """Lines, how often others are on each layer, what else is missing, and names of layers by `key`."""

    lines: list[Line]
    others: Counter[tuple[str, str]]
    absent: Counter[str]
    names: dict[str, str]


def key(layer: str) -> str:
    """Return what is equal for equal layers: upper and lower case do not matter in DXF."""
    return layer.lower()


def read_drawing(path: Path) -> tuple[Drawing, Content]:
    """Return a drawing, and what is known of its content before it is taken apart.

    Raises: ScenarioError: it cannot be read.
    """
    try:
        if _form(path) == "DWG":
            import ezdwg  # noqa: F401  # before ezdxf, which its extra includes, so that a message names this extra
        import ezdxf
    except (configparser.Error, UnicodeDecodeError) as error:
        raise ScenarioError(f"ezdxf: its configuration is damaged: {printable(' '.join(str(error).split()))}") from None
    if not is_file(path):
        raise ScenarioError(f"{path}: there is no such file")
    if path.stat().st_size > MOST_BYTES:
        raise ScenarioError(f"{path}: larger than {MOST_BYTES // 2**20} MiB; expected a drawing of one floor")
    try:
        if _form(path) == "DWG":
            return _of_dwg(path)
        drawing = ezdxf.readfile(path)
        return drawing, Content([], Counter(), Counter(), _layer_names(drawing))
    except (KeyboardInterrupt, ScenarioError, ModuleNotFoundError):
        raise
    except MemoryError:
        pass  # so that what was read is freed first
    except BaseException as error:  # damaged files cause IndexError, KeyError, panics of ezdwg and others
        raise _unreadable(path, error) from None
    raise ScenarioError(f"{path}: cannot be read as {_form(path)}: out of memory")


def _of_dwg(path: Path) -> tuple[Drawing, Content]:
    """Return the drawing and the content of a DWG file."""
    found = read_dwg(path, MOST_LINES)
    names = _layer_names(found.drawing)
    others = Counter[tuple[str, str]]()
    for (layer, kind), number in found.others.items():
        names.setdefault(key(layer), layer)
        others[key(layer), kind] += number
    unknown = f"{counted(found.num_unknown, 'object')} of unknown kinds, perhaps without a shape"
    return found.drawing, Content([], others, Counter([unknown] if found.num_unknown else []), names)


def _layer_names(drawing: Drawing) -> dict[str, str]:
    return {key(layer.dxf.name): layer.dxf.name for layer in drawing.layers}


def _form(path: Path) -> str:
    """Return the name of a file's format."""
    return "DWG" if path.suffix.lower() == ".dwg" else "DXF"


def _unreadable(path: Path, error: BaseException) -> ScenarioError:
    """Return the line for an error of ezdxf or ezdwg; those of Python mean nothing to the user."""
    from ezdxf import DXFError

    reason = "it is damaged"
    if isinstance(error, DXFError):
        reason = " ".join(str(error).split()).removeprefix("DXFStructureError: ").rstrip(".") or reason
    elif isinstance(error, OSError):  # also those that have no number, of ezdxf
        reason = error.strerror or f"it is not a {_form(path)} file"
    elif isinstance(error, RecursionError):
        reason = "a block contains itself"
    elif isinstance(error, MemoryError):
        reason = "out of memory"
    return ScenarioError(f"{path}: cannot be read as {_form(path)}: {printable(reason)}")


def metres_per_unit(path: Path, drawing: Drawing) -> float:
    """Return the scale that a file names. Raises: ScenarioError: it names none."""
    from ezdxf.enums import InsertUnits
    from ezdxf.units import conversion_factor

    problem = "names no known unit"
    try:
        if unit := InsertUnits(drawing.units):
            return conversion_factor(unit, InsertUnits.Meters)
    except ValueError:
        pass
    except TypeError:  # ezdxf converts only some, without the feet of surveyors
        problem = "has a unit that cannot be converted"
    text = f"{problem} ($INSUNITS {drawing.units}); give its scale with --metres-per-unit"
    raise ScenarioError(f"{path}: {text}")


def take_apart(path: Path, drawing: Drawing, flat: float | None, found: Content) -> None:
    """Add what a drawing contains.

    Args:   flat: how far straight lines may be from a curve, in units of the drawing; None: a share of its size.
    Raises: ScenarioError: it cannot be read, or there are too many parts.
    """
    try:
        if _num_parts(drawing) > MOST_LINES:
            raise ScenarioError(f"{path}: more than {MOST_LINES} lines and other parts, with those of repeated blocks")
        for name, part in _parts(drawing.modelspace(), None, found.absent):
            found.names.setdefault(key(name), name)
            count = len(found.lines)
            for piece, width in _pieces(part):
                found.lines.extend(Line(key(name), ends, width) for ends in _straight(piece, flat))
            if len(found.lines) == count:
                found.others[key(name), part.dxftype()] += 1
            if len(found.lines) > MOST_LINES:
                raise ScenarioError(f"{path}: more than {MOST_LINES} lines")
    except ScenarioError:
        raise
    except Exception as error:  # a block that contains itself, and what the file says wrongly
        raise _unreadable(path, error) from None


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


def _flat(part: DXFEntity, flat: float | None) -> float:
    """Return how far lines may be from a curve: not less than a share of its size, so that they are not too many.

    Raises: DXFValueError: numbers of that size cannot be divided into lines.
    """
    from ezdxf import DXFValueError, bbox

    if part.dxftype() == "LINE":
        return LARGEST
    box = bbox.extents([part], fast=True)
    if not box.has_data:  # without points
        return LARGEST
    size = max(box.size.x, box.size.y)
    if not size <= LARGEST:
        raise DXFValueError(f"a {part.dxftype()} has a size of {size:g}")
    return float(max(flat, LEAST_SHARE * size) if flat is not None else COARSE_SHARE * size)


def _parts(
    entities: Iterable[DXFEntity], reference: str | None, absent: Counter[str]
) -> Iterator[tuple[str, DXFEntity]]:
    """Yield what is visible, and its layer; blocks and composed parts are taken apart.

    Args: reference: layer of the block reference, which is that of parts on layer 0.  absent: counts what is not in
          the file.
    """
    from ezdxf.entities import Insert
    from ezdxf.protocols import SupportsVirtualEntities, virtual_entities

    for entity in entities:
        layer, is_invisible = _layer(entity)
        if is_invisible or entity.dxftype() in _TEXTS:
            continue
        if layer == "0" and reference is not None:
            layer = reference
        if isinstance(entity, Insert) and (name := _absent(entity)):
            absent[name] += 1
        elif isinstance(entity, Insert):
            for one in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _parts(one.virtual_entities(), layer, absent)
        elif isinstance(entity, SupportsVirtualEntities) and (parts := list(virtual_entities(entity))):
            yield from _parts(parts, layer, absent)
        else:
            yield layer, entity


def _layer(entity: DXFEntity) -> tuple[str, bool]:
    """Return the layer of an entity, and whether it is invisible (group code 60)."""
    from ezdxf.entities import DXFTagStorage

    if isinstance(entity, DXFTagStorage):  # of a kind that ezdxf does not know
        properties = entity.graphic_properties()
        return properties.get("layer", "0"), bool(properties.get("invisible"))
    return str(entity.dxf.layer), bool(entity.dxf.get("invisible"))


def _absent(reference: Insert) -> str | None:
    """Return what a block reference shows, if that is not in the file."""
    layout = reference.block()
    if layout is None or layout.block is None:
        return f"missing block '{reference.dxf.name}'"
    if layout.block_record.is_xref:
        return f"attached drawing '{layout.block.dxf.xref_path or reference.dxf.name}'"
    return None


def _pieces(part: DXFEntity) -> Iterable[tuple[DXFEntity, float]]:
    """Return lines and curves with their widths: a polyline with widths as its segments, nothing of other parts."""
    from ezdxf.entities import LWPolyline, Polyline

    if isinstance(part, Polyline) and (part.is_2d_polyline or part.is_3d_polyline):
        # The control points of a smoothed polyline are not on it.
        part.vertices[:] = [one for one in part.vertices if not one.dxf.flags & one.SPLINE_FRAME_CONTROL_POINT]
    elif not isinstance(part, LWPolyline):
        return [(part, 0.0)] if part.dxftype() in _CURVES else []
    if not part.has_width:
        return [(part, 0.0)]
    if isinstance(part, LWPolyline):
        points = part.get_points("xyseb")
        if const := part.dxf.const_width:  # CAD programs ignore all others then
            points = [(x, y, const, const, bulge) for x, y, _, _, bulge in points]
    else:
        ends = part.dxf.default_start_width, part.dxf.default_end_width
        points = [
            (*vertex.format("xy"), *map(vertex.dxf.get, ("start_width", "end_width"), ends), vertex.dxf.bulge)
            for vertex in part.vertices
        ]
    pairs = zip(points, [*points[1:], *points[:1]], strict=True)
    # ezdxf leaves out an arc between equal points.
    widths = [0.5 * (one[2] + one[3]) for one, other in pairs if not one[4] or one[:2] != other[:2]]
    return zip(part.virtual_entities(), widths, strict=False)


def _straight(part: DXFEntity, flat: float | None) -> Iterator[np.ndarray]:
    """Yield the ends of the straight lines of a line or curve."""
    from ezdxf import disassemble

    points = [(point.x, point.y) for point in disassemble.make_primitive(part, _flat(part, flat)).vertices()]
    for one, other in itertools.pairwise(points):
        yield np.array([one, other])
