"""One storey of an IFC building as walls, blocks and doors of a floor plan."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import shapely

from robotteamsim.formats.ifc_file import Entity, IfcBuilding, Rise, Solid, Storey
from robotteamsim.formats.ifc_materials import IfcMaterials
from robotteamsim.formats.ifc_shapes import (
    FLAT_M,
    THROUGH,
    Mesh,
    Strip,
    as_strip,
    face_to_face,
    footprint,
    outlines,
    remaining,
    spanned,
    without_holes,
)
from robotteamsim.map_import.thickness import piece_thickness
from robotteamsim.scenario.image_walls import MAX_WALL_THICKNESS_M, THICKEST_M
from robotteamsim.wording import counted, printable

FLOOR_M, HEAD_M = 0.05, 2.0
"""What is between these heights above the floor blocks robots: not what ends in the floor, nor what is above heads."""

STEP_M = 0.3
"""A door is a storey's if its sill is at most this far from the floor."""

PASSABLE_M = 1.0
"""An opening without a filling is passable if it reaches from the floor to at least this height."""

WINDOW_M = 0.5
"""A window is one of a storey if it has at least this height between the floor and heads."""

CLOSE_M, STAIRS_M = 0.05, 0.2
"""Gaps between steps that are closed, half; and the thickness of the wall that stairs are to radio."""

_BESIDE_M = 0.3
"""A door that fills no opening cuts the walls that are that close in front of it or behind it."""

_LEAST_LEAF_M = 0.05
_MOST_HEIGHT_M = 20.0

_RATING = re.compile(
    r"\b(?:R?EI?|REI|RE|EW|T|F|FD|FH|G|R)[ -]?0*[1-9]\d{1,2}\b|\b0*[1-9]\d*\s*-?\s*min(?:ute)?s?\b", re.IGNORECASE
)
"""A class with a number, such as EI 60 or T30, or minutes."""


@dataclass(frozen=True, slots=True, eq=False)
class _Gap:
    """An opening. owner: of one wall; None: of all.  filling: None: nothing.  hosts: what it goes through."""

    owner: int | None
    shape: shapely.Geometry
    filling: Entity | None
    high_m: float
    hosts: list[_Standing] = field(default_factory=list)

    @property
    def is_window(self) -> bool:
        """Whether it lets radio pass, but not robots."""
        return self.filling is not None and bool(self.filling.is_a("IfcWindow"))

    @property
    def door(self) -> Entity | None:
        """The door in it."""
        return None if self.is_window else self.filling


class _Standing(NamedTuple):
    """Part of a solid as seen from above. strip: if it is a straight wall."""

    solid: Solid
    shape: shapely.Polygon
    strip: Strip | None
    gaps: list[_Gap]


class StoreyNotes:
    """What was guessed or left out on the storeys that were drawn.

    materials: of their walls, blocks and columns.
    said:      how many of what, such as "door narrower than 0.05 m".
    misplaced: one line for each door that is in no gap.
    num_walls: number of straight walls.
    """

    def __init__(self, building: IfcBuilding) -> None:
        self.materials = IfcMaterials(building.scale_m)
        self.said: Counter[str] = Counter()
        self.misplaced: list[str] = []
        self.left_out: Counter[str] = Counter()
        self.num_walls = 0
        self._with_doors: dict[str, bool] = {}

    def add(self, name: str, left_out: Counter[str], *, has_doors: bool) -> None:
        """Add a storey. Args: left_out: numbers of elements by their class."""
        self.left_out += left_out
        self._with_doors[name] = has_doors

    def __iter__(self) -> Iterator[str]:
        yield from self.materials.notes()
        for what, number in (+self.said).items():
            noun, rest = what.split(" ", 1)
            yield f"{counted(number, noun)} {rest}"
        if self.left_out:
            yield "left out: " + ", ".join(f"{number} {name}" for name, number in sorted(self.left_out.items()))
        if any(self._with_doors.values()):
            yield "doors are open at the start; `motion` in the plan would move their leaves"
        if without := [name for name, has_doors in self._with_doors.items() if not has_doors]:
            yield f"there is no door on {'storeys' if len(without) > 1 else 'storey'} {', '.join(without)}"
        yield from self.misplaced


class StoreyPlan:
    """Walls, blocks and doors of a storey, as keys of a floor plan."""

    def __init__(self, building: IfcBuilding, storey: Storey, notes: StoreyNotes) -> None:
        """Cut the building between the floor and heads. Args: notes: to which those on this storey are added."""
        self._building, self._storey = building, storey
        self._low_m, self._high_m = storey.floor_m + FLOOR_M, storey.floor_m + HEAD_M
        self._materials, self._said = notes.materials, notes.said
        gaps: dict[int | None, list[_Gap]] = {}
        for gap in self._gaps():
            gaps.setdefault(gap.owner, []).append(gap)
        standing = [one for solid in building.solids for one in self._stand(solid, gaps)]
        self.walls: list[dict[str, Any]] = []
        self.blocks: list[dict[str, Any]] = []
        names: Counter[str] = Counter()
        for one in standing:
            for keys in self._elements(one):
                base = f"{_kind(one.solid.element)}_{one.solid.element.id()}"
                names[base] += 1
                keys["name"] = base if names[base] == 1 else f"{base}_{names[base]}"
        self.blocks += [block for rise in building.rises if rise.kind != "lift" for block in self._bodies(rise)]
        strips = [one.strip for one in standing if one.strip]
        self._said["wall in front of a parallel one: of both, the higher loss counts"] += len(face_to_face(strips))
        notes.num_walls += len({one.solid.element.id() for one in standing if one.strip})
        with_doors = [gap for some in gaps.values() for gap in some if gap.door is not None]
        leaves = [leaf for gap in with_doors for leaf in self._leaves(gap, gap.door)]
        self.doors = list({leaf["name"]: leaf for leaf in leaves}.values())  # an opening may be of several parts
        notes.add(storey.name, building.left_out(storey), has_doors=bool(self.doors))

    def _gaps(self) -> Iterator[_Gap]:
        """Yield the openings that a robot can pass, and windows."""
        for opening in self._building.openings:
            mesh, doors = opening.mesh, opening.doors
            if mesh is None or mesh.high_m <= self._low_m or mesh.low_m >= self._high_m:
                continue
            if opening.fillings and not doors:
                window = next((one for one in opening.fillings if one.is_a("IfcWindow")), None)
                if window and min(mesh.high_m, self._high_m) - max(mesh.low_m, self._low_m) >= WINDOW_M:
                    for shape in footprint(mesh, mesh.low_m - 1.0, mesh.high_m + 1.0):
                        yield _Gap(opening.owner, shape, window, mesh.high_m)
                continue
            if not self._is_passable(mesh, bool(doors)):
                self._said[f"{'door' if doors else 'opening'} with a sill not at the floor: closed"] += 1
                continue
            for shape in footprint(mesh, mesh.low_m - 1.0, mesh.high_m + 1.0):
                if len(opening.fillings) < 2:
                    yield _Gap(opening.owner, shape, doors[0] if doors else None, mesh.high_m)
                    continue
                for door in doors:
                    box = self._box(door, 10.0)
                    part = shape if box is None else shape.intersection(box)
                    if part.area > 0.0:
                        yield _Gap(opening.owner, part, door, mesh.high_m)
        filled = {door.id() for opening in self._building.openings for door in opening.doors}
        for door in self._building.doors:
            if door.id() in filled:
                continue
            mesh = self._building.bodies.get(door.id())
            if mesh is None:
                self._said["door without an opening and without a shape"] += 1
            elif self._is_passable(mesh, True) and (box := self._box(door, _BESIDE_M)) is not None:
                yield _Gap(None, box, door, mesh.high_m)

    def _is_passable(self, mesh: Mesh, is_door: bool) -> bool:
        begin_m = mesh.low_m - self._storey.floor_m
        begins = abs(begin_m) <= STEP_M if is_door else begin_m <= FLOOR_M
        return begins and mesh.high_m - self._storey.floor_m >= PASSABLE_M

    def _box(self, door: Entity, beside_m: float) -> shapely.Polygon | None:
        """Return the rectangle around the body of a door along its own axis, wider across; None: it has no body."""
        mesh = self._building.bodies.get(door.id())
        if mesh is None:
            return None
        along = _axis(door)
        across = np.array([-along[1], along[0]])
        points = shapely.multipoints(mesh.corners[..., :2].reshape(-1, 2))
        (a, b), (c, d) = spanned(points, np.zeros(2), along), spanned(points, np.zeros(2), across)
        c, d = c - beside_m, d + beside_m
        return shapely.Polygon(
            [a * along + c * across, b * along + c * across, b * along + d * across, a * along + d * across]
        )

    def _stand(self, solid: Solid, gaps: Mapping[int | None, Sequence[_Gap]]) -> Iterator[_Standing]:
        """Yield what a solid has between the floor and heads, and the gaps in it."""
        if solid.mesh.high_m <= self._low_m or solid.mesh.low_m >= self._high_m:
            return
        owners = dict.fromkeys((None, solid.element.id(), solid.whole.id()))
        for part in footprint(solid.mesh, self._low_m, self._high_m):
            shape = shapely.Polygon(part.exterior) if _is_column(solid) else part
            strip = None if _is_column(solid) else as_strip(shape)
            if strip and strip.thickness_m > MAX_WALL_THICKNESS_M:
                strip = None
            here = [gap for owner in owners for gap in gaps.get(owner, ()) if gap.shape.intersects(shape)]
            one = _Standing(solid, shape, strip, here)
            for gap in here:
                gap.hosts.append(one)
            yield one

    def _elements(self, one: _Standing) -> Iterator[dict[str, Any]]:
        """Yield the pieces of a standing part, and add them to walls and blocks."""
        is_glazed = not one.solid.element.is_a("IfcWall") and any(
            map(one.solid.whole.is_a, ("IfcCurtainWall", "IfcWindow"))
        )
        height_m = min(one.solid.mesh.high_m - self._storey.floor_m, _MOST_HEIGHT_M)
        keys: dict[str, Any] = {"name": "", "height_m": round(height_m, 3)}
        if one.strip:
            keys["material"] = self._materials.of(one.solid.element, one.strip.thickness_m, is_glazed=is_glazed)
            yield from self._pieces(one, one.strip, keys)
            return
        if _is_column(one.solid):
            keys["kind"] = "pillar"
            thickness_m = min(one.shape.bounds[2] - one.shape.bounds[0], one.shape.bounds[3] - one.shape.bounds[1])
        else:
            thickness_m = _thickness_m(one.shape)
            keys["thickness_m"] = thickness_m or None
        keys["material"] = self._materials.of(one.solid.element, thickness_m, is_glazed=is_glazed)
        self._said["window closed, of the material of the wall around it"] += sum(gap.is_window for gap in one.gaps)
        rest = one.shape.difference(shapely.union_all([gap.shape for gap in one.gaps if not gap.is_window]))
        for part in shapely.get_parts(rest):
            for piece in without_holes(part):
                outline = shapely.set_precision(piece, 1e-6)
                if isinstance(outline, shapely.Polygon) and outline.area > FLAT_M**2:
                    corners = shapely.get_coordinates(outline.exterior)[:-1].round(6)
                    self.blocks.append({**keys, "polygon": [tuple(corner) for corner in corners.tolist()]})
                    yield self.blocks[-1]

    def _pieces(self, one: _Standing, strip: Strip, keys: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """Yield what openings leave of a straight wall, with its windows as pieces of glass."""
        spans = [(gap, span) for gap in one.gaps if (span := self._opened(strip, gap))]
        windows = [span for gap, span in spans if gap.is_window]
        self._said["window closed with glass of 6 mm"] += len(windows)
        openings = [span for gap, span in spans if not gap.is_window]
        opaque = list(remaining(strip.length_m, [*openings, *windows]))
        pieces = [(*span, keys["material"]) for span in opaque]
        pieces += [(*span, self._materials.glass()) for span in remaining(strip.length_m, [*openings, *opaque])]
        for begin_m, end_m, material in sorted(pieces, key=lambda piece: piece[0]):
            ends = {"from": strip.at(begin_m), "to": strip.at(end_m)}
            self.walls.append({**keys, **ends, "thickness_m": strip.thickness_m, "material": material})
            yield self.walls[-1]

    def _bodies(self, rise: Rise) -> Iterator[dict[str, Any]]:
        """Yield what blocks robots of stairs or a ramp; to radio, it is a wall."""
        parts = [part for mesh in rise.meshes for part in footprint(mesh, self._low_m, self._high_m)]
        closed = shapely.union_all(parts).buffer(CLOSE_M, join_style="mitre").buffer(-CLOSE_M, join_style="mitre")
        height_m = max(mesh.high_m for mesh in rise.meshes) - self._storey.floor_m if rise.meshes else 0.0
        for number, (corners, _) in enumerate(outlines(closed), 1):
            yield {
                "name": f"{rise.kind}_{rise.element.id()}" + (f"_{number}" if number > 1 else ""),
                "polygon": corners,
                "thickness_m": STAIRS_M,
                "height_m": round(min(height_m, _MOST_HEIGHT_M), 3),
                "material": None,
            }

    def _opened(self, strip: Strip, gap: _Gap) -> tuple[float, float] | None:
        """Return where a gap opens a wall; the opening of a door need not go through."""
        return strip.opened_by(gap.shape, 0.0 if gap.door is not None and gap.owner is not None else THROUGH)

    def _leaves(self, gap: _Gap, door: Entity) -> Iterator[dict[str, Any]]:
        """Yield the leaves of a door, open; a double door is two, from both sides."""
        cut = shapely.union_all([one.shape.intersection(gap.shape) for one in gap.hosts])
        along = _axis(door)
        for strip in (one.strip for one in gap.hosts if one.strip):
            along = strip.along if strip.along @ along >= 0.0 else -strip.along
            break
        across = np.array([-along[1], along[0]])
        shape = gap.shape if cut.is_empty or gap.owner is None else cut
        (a, b), (c, d) = spanned(shape, np.zeros(2), along), spanned(shape, np.zeros(2), across)
        if b - a < _LEAST_LEAF_M:
            self._said[f"door narrower than {_LEAST_LEAF_M:g} m, left out"] += 1
            return
        left, right = ((place * along + 0.5 * (c + d) * across).round(6) for place in (a, b))
        operation = _operation(door)
        leaves = [("", left, right)]
        if operation.startswith(("DOUBLE_DOOR", "DOUBLE_PANEL")):
            middle = (0.5 * (left + right)).round(6)
            leaves = [("_left", left, middle), ("_right", right, middle)]
        elif operation.endswith("RIGHT"):
            leaves = [("", right, left)]
        height_m = min(gap.high_m - self._storey.floor_m, _MOST_HEIGHT_M)
        kind = "fireproof" if self._is_fireproof(door) else "normal"
        for side, hinge, other in leaves:
            ends = {"from": tuple(hinge.tolist()), "to": tuple(other.tolist())}
            yield {"name": f"door_{door.id()}{side}", **ends, "height_m": round(height_m, 3), "kind": kind}

    def _is_fireproof(self, door: Entity) -> bool:
        """Whether the FireRating of a door, a free text, says how long it stands a fire."""
        from ifcopenshell.util.element import get_pset

        text = str(get_pset(door, "Pset_DoorCommon", "FireRating") or "").strip()
        if text and not _RATING.search(text):
            self._said[f"door whose FireRating has neither minutes nor a class: '{printable(text)}'"] += 1
        return bool(_RATING.search(text))


def has_doors(building: IfcBuilding, storey: Storey) -> bool:
    """Whether the sill of a door is at the floor of a storey."""
    meshes = [opening.mesh for opening in building.openings if opening.mesh and opening.doors]
    return any(abs(mesh.low_m - storey.floor_m) <= STEP_M for mesh in (*meshes, *building.bodies.values()))


def has_walls(building: IfcBuilding, storey: Storey) -> bool:
    """Whether something blocks robots on a storey."""
    low_m, high_m = storey.floor_m + FLOOR_M, storey.floor_m + HEAD_M
    return any(solid.mesh.high_m > low_m and solid.mesh.low_m < high_m for solid in building.solids)


def on_none(building: IfcBuilding, storeys: Sequence[Storey]) -> list[Entity]:
    """Return what blocks robots on none of some storeys, for it is above heads or below the floor."""
    bands_m = np.array([(storey.floor_m + FLOOR_M, storey.floor_m + HEAD_M) for storey in storeys])
    heights_m = ((solid.element, solid.mesh.low_m, solid.mesh.high_m) for solid in building.solids)
    return [one for one, low_m, high_m in heights_m if not np.any((high_m > bands_m[:, 0]) & (low_m < bands_m[:, 1]))]


def _thickness_m(shape: shapely.Polygon) -> float:
    """Return the thickness of a wall that is not straight, in whole millimetres."""
    in_mm = shapely.transform(shape, lambda points_m: points_m / FLAT_M)
    corners = shapely.get_coordinates(in_mm.exterior)[:-1]
    return round(float(piece_thickness(in_mm, [corners], THICKEST_M / FLAT_M)[0]) * FLAT_M, 3)


def _is_column(solid: Solid) -> bool:
    return bool(solid.whole.is_a("IfcColumn"))


def _kind(element: Entity) -> str:
    """Return a word for the class of an element, such as wall."""
    known = "IfcWall", "IfcColumn", "IfcPlate", "IfcMember", "IfcWindow"
    return next((name.removeprefix("Ifc").lower() for name in known if element.is_a(name)), "part")


def _axis(door: Entity) -> np.ndarray:
    """Return the direction of a door's width in the map, from left to right seen from behind; float64, shape (2,)."""
    from ifcopenshell.util.placement import get_local_placement

    if door.ObjectPlacement is None:
        return np.array([1.0, 0.0])
    axis = np.asarray(get_local_placement(door.ObjectPlacement)[:2, 0], dtype=float)
    length = float(np.hypot(*axis))
    return axis / length if length > 0.5 else np.array([1.0, 0.0])


def _operation(door: Entity) -> str:
    """Return how a door moves, such as SINGLE_SWING_LEFT, by itself or by its type."""
    from ifcopenshell.util.element import get_type

    own = getattr(door, "OperationType", None)
    return str(own or getattr(get_type(door), "OperationType", None) or "")
