"""Drawings in DWG, the format of AutoCAD, as drawings of ezdxf: one code takes the walls of both.

The packages ezdwg and ezdxf are imported where they are used, because they belong to an extra.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from robotteamsim.errors import ScenarioError
from robotteamsim.wording import printable

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts import BaseLayout

Values = Mapping[str, Any]
"""Of an entity, by the keys of ezdwg."""

_VERSIONS = ("AC1014", "AC1015", "AC1018", "AC1021", "AC1024", "AC1027", "AC1032")
"""Of R13, AC1012, ezdwg does not decode the names of layers."""

_MODEL_SPACE, _NOT_SHOWN = 0, -1
"""In place of the handle of a block, which is above 0."""

_OWNED, _ON_PAPER = 0, 1
"""Whether an entity has an owner, or is on the current sheet of paper [ezdwg, `Document.entity_placement`]."""

_UNKNOWN_LAYER = "unknown layer"

_PARTS_OF_OTHERS = ("BLOCK", "ENDBLK", "SEQEND", "VERTEX_")
_DIMENSIONS = ("ARC_DIM", "DIM", "LARGE_RADIAL", "LEADER", "MULTILEADER", "TOLERANCE")
_NO_WALLS = (*_DIMENSIONS, "ATTDEF", "ATTRIB", "MTEXT", "POINT", "TEXT", "VIEWPORT")
"""Begins of kinds that are not counted: as in DXF, texts and dimension lines are no walls."""


class DwgContent(NamedTuple):
    """What a file contains.

    drawing:     its lines, curves and block references; its blocks have their handles as names.
    others:      how often each kind of part that is not translated, or cannot be decoded, is on a layer: in the model
                 space and, once, in each block that it shows.
    num_unknown: objects of which ezdwg does not know what they are, on no layer.
    """

    drawing: Drawing
    others: Counter[tuple[str, str]]
    num_unknown: int


def read_dwg(path: Path, most_parts: int) -> DwgContent:
    """Return what a drawing of AutoCAD R14 to 2018 contains.

    `to_dxf` and `Document.edit` of ezdwg 0.17 would lose some of it, see docs/formats_of_buildings.md. So each entity
    that the file lists is looked up here, and is translated or counted.

    Args:   most_parts: in the file.
    Raises: ScenarioError: there are more parts, some are missing, or the file is of another version.
            ValueError, and any other error of ezdwg and ezdxf: the file is damaged.
    """
    import ezdwg
    from ezdwg import raw

    file = str(path)
    if (version := raw.detect_version(file)) not in _VERSIONS:
        raise ScenarioError(f"{path}: version '{printable(version)}'; expected a DWG file of AutoCAD R14 to 2018")
    ezdwg.clear_decode_caches()  # they keep what another file of this name had
    listed = raw.list_object_headers_with_type(file)
    if num_missing := len(raw.list_object_map_entries(file)) - len(listed):
        raise ScenarioError(f"{path}: damaged: {num_missing} of its objects cannot be read")
    kinds = {handle: kind for handle, *_, kind, kind_class in listed if kind_class == "E"}
    if len(kinds) > most_parts:
        raise ScenarioError(f"{path}: {len(kinds)} lines and other parts; expected at most {most_parts}")
    counted = {handle: kind for handle, kind in kinds.items() if not kind.startswith((*_PARTS_OF_OTHERS, *_NO_WALLS))}
    translation = _Translation(file, counted)
    num_unknown = sum(kind_class == "" for *_, kind_class in listed)
    return DwgContent(translation.drawing, translation.others(), num_unknown)


class _Translation:
    """A file of ezdwg as a drawing of ezdxf, and what is not in that."""

    def __init__(self, file: str, kinds: Mapping[int, str]) -> None:
        """Translate a file. Args: kinds: of the entities that are translated or counted, by handle."""
        import ezdwg
        import ezdxf
        from ezdwg import raw

        self._document = ezdwg.read(file)
        self._layers = {layer.handle: layer.name for layer in self._document.layers}
        self._others: dict[int, Counter[tuple[str, str]]] = defaultdict(Counter)
        self._shown: dict[int, set[int]] = defaultdict(set)
        self.drawing = ezdxf.new()
        self.drawing.header["$INSUNITS"] = self._document.insunits or 0
        for name in self._layers.values():
            if name not in self.drawing.layers:
                self.drawing.layers.add(name)
        self._layouts: dict[int, BaseLayout] = {_MODEL_SPACE: self.drawing.modelspace()}
        self._spaces: dict[int, int] = {}
        for row in raw.decode_write_blocks(file):
            self._add_block(row)

        entities = {entity.handle: entity for entity in self._document.entities().query(tuple(_ADD))}
        more: dict[int, Values] = {row["handle"]: row for row in raw.decode_write_splines(file)}
        more |= {handle: {"block": block} for handle, _, block, _ in raw.decode_insert_write_properties(file)}
        for handle, entity in list(entities.items()):
            if entity.dxftype in ("INSERT", "SPLINE") and handle not in more:
                del entities[handle]  # it is not decoded completely
            else:
                entity.dxf.update(more.get(handle, {}))
        layers = dict(raw.decode_object_entity_layer_handles(file, [h for h in kinds if h not in entities]))
        for handle, kind in kinds.items():
            owner = self._owner(handle)
            if owner == _NOT_SHOWN:
                continue
            if handle in entities:
                self._add(owner, entities[handle].dxftype, entities[handle].dxf)
            else:
                self._count(owner, kind, layers.get(handle))

    def _add_block(self, row: Values) -> None:
        """Add a block without its parts. Args: row: its handle, name, base point, and what it is besides."""
        handle, name = row["handle"], row["name"]
        if name.upper().startswith("*MODEL_SPACE"):
            self._spaces[handle] = _MODEL_SPACE
        elif name.upper().startswith("*PAPER_SPACE"):
            self._spaces[handle] = _NOT_SHOWN
        elif "xref" in row["losses"]:
            self._spaces[handle] = _NOT_SHOWN
            self.drawing.add_xref_def(name, _block_name(handle))
        else:
            self._layouts[handle] = self.drawing.blocks.new(_block_name(handle), base_point=row["base_point"])

    def _owner(self, handle: int) -> int:
        """Return the handle of the block that has an entity, or _MODEL_SPACE, also if it is unknown, or _NOT_SHOWN."""
        space, owner = self._document.entity_placement(handle) or (None, None)
        if space == _ON_PAPER:
            return _NOT_SHOWN
        if space != _OWNED or owner is None:
            return _MODEL_SPACE
        return owner if owner in self._layouts else self._spaces.get(owner, _MODEL_SPACE)

    def _add(self, owner: int, kind: str, values: Values) -> None:
        """Add an entity to the layout of its owner."""
        if kind == "INSERT":
            self._shown[owner].add(values["block"])
        given = {key: values[key] for key in ("extrusion", "invisible") if key in values}
        attributes = {**given, "layer": self._layers.get(values["layer_handle"], _UNKNOWN_LAYER)}
        _ADD[kind](self._layouts[owner], values, attributes)

    def _count(self, owner: int, kind: str, layer_handle: int | None) -> None:
        """Count an entity that is not translated."""
        layer = self._layers.get(layer_handle or 0, _UNKNOWN_LAYER)
        # Kinds of other programs have a description behind their name.
        name = f"undecoded {kind}" if kind in _ADD else kind.partition("|")[0]
        self._others[owner][layer, name] += 1

    def others(self) -> Counter[tuple[str, str]]:
        """Return how often each kind that is not translated is on a layer, of what the model space shows."""
        seen: set[int] = set()
        ahead = [_MODEL_SPACE]
        while ahead:
            owner = ahead.pop()
            if owner not in seen:
                seen.add(owner)
                ahead += self._shown[owner]
        return sum((self._others[owner] for owner in sorted(seen)), Counter[tuple[str, str]]())


def _block_name(handle: int) -> str:
    return f"{handle:X}"


def _vertices(values: Values) -> list[tuple[float, ...]]:
    """Return x, y, widths at the start and the end, and bulge of each vertex of a polyline."""
    columns = values["points"], values["widths"], values["bulges"]
    return [(*point[:2], *widths, bulge) for point, widths, bulge in zip(*columns, strict=True)]


def _add_line(layout: BaseLayout, values: Values, attributes: Values) -> None:
    layout.add_line(values["start"], values["end"], attributes)


def _add_arc(layout: BaseLayout, values: Values, attributes: Values) -> None:
    angles_deg = values["start_angle"], values["end_angle"]
    layout.add_arc(values["center"], values["radius"], *angles_deg, dxfattribs=attributes)


def _add_circle(layout: BaseLayout, values: Values, attributes: Values) -> None:
    layout.add_circle(values["center"], values["radius"], dxfattribs=attributes)


def _add_ellipse(layout: BaseLayout, values: Values, attributes: Values) -> None:
    parameters = values["axis_ratio"], values["start_angle"], values["end_angle"]
    layout.add_ellipse(values["center"], values["major_axis"], *parameters, dxfattribs=attributes)


def _add_spline(layout: BaseLayout, values: Values, attributes: Values) -> None:
    tangents = {key: values[key] for key in ("start_tangent", "end_tangent") if any(values.get(key) or ())}
    spline = layout.add_spline(values["fit_points"], values["degree"], dxfattribs={**attributes, **tangents})
    spline.control_points, spline.knots, spline.weights = (
        values[key] for key in ("control_points", "knots", "weights")
    )


def _add_lwpolyline(layout: BaseLayout, values: Values, attributes: Values) -> None:
    polyline = layout.add_lwpolyline(_vertices(values), close=values["closed"], dxfattribs=attributes)
    if values["const_width"] is not None:
        polyline.dxf.const_width = values["const_width"]


def _add_polyline_2d(layout: BaseLayout, values: Values, attributes: Values) -> None:
    polyline = layout.add_polyline2d(_vertices(values), "xyseb", close=values["closed"], dxfattribs=attributes)
    for vertex, flags in zip(polyline.vertices, values["vertex_flags"], strict=True):
        vertex.dxf.flags = flags


def _add_polyline_3d(layout: BaseLayout, values: Values, attributes: Values) -> None:
    layout.add_polyline3d(values["points"], close=values["closed"], dxfattribs=attributes)


def _add_insert(layout: BaseLayout, values: Values, attributes: Values) -> None:
    scales = {key: values[key] for key in ("xscale", "yscale", "zscale", "rotation")}
    layout.add_blockref(_block_name(values["block"]), values["insert"], dxfattribs={**attributes, **scales})


_ADD: Mapping[str, Callable[[BaseLayout, Values, Values], None]] = {
    "LINE": _add_line,
    "ARC": _add_arc,
    "CIRCLE": _add_circle,
    "ELLIPSE": _add_ellipse,
    "SPLINE": _add_spline,
    "LWPOLYLINE": _add_lwpolyline,
    "POLYLINE_2D": _add_polyline_2d,
    "POLYLINE_3D": _add_polyline_3d,
    "INSERT": _add_insert,
}
"""What adds an entity to a layout, by its kind: the values of ezdwg, and the attributes that all kinds have."""
