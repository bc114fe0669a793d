"""The faces of a floor plan: the losses of rays at the outlines of walls, blocks and doors."""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from robotteamsim import _core
from robotteamsim.errors import ScenarioError
from robotteamsim.propagation.crossings import round_outwards
from robotteamsim.propagation.mass_law import mass_law_loss_db
from robotteamsim.propagation.slab import wall_loss_db
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Block, Door, FloorPlan, Wall
from robotteamsim.scenario.levels import Level, ceiling_height_m
from robotteamsim.scenario.plan import Solid, footprints, solids
from robotteamsim.scenario.sections import Radio, Voice

MM_PER_M = 1000.0
UNITS_PER_DB = 20
"""Weights of losses are in units of 0.05 dB: a loss is a multiple of 0.1 dB, so half of it is a whole number."""

_CLASS_LIMITS_MM = (200, 400, 600)
"""Thickest wall of each of the first three classes of Table 3; all thicker walls are in the fourth, ]60,80] cm."""

_COUNTED = -1
"""In place of the loss of a floor that costs `radio.floor_loss_db` and counts as one of k floors."""

_HALF_TOLERANCE = 1e-6
"""A number this near to a half is a half: 8.0255 m is 8025.499999999999 mm in doubles."""


@dataclass(frozen=True, slots=True, eq=False)
class Faces:
    """Segments that attenuate rays crossing them; the last ones are the doors, in the plan's order.

    ends_mm: int64, shape (n, 4): x1, y1, x2, y2 in `map` [mm].
    weights: int32, shape (n,), > 0: half of what the loss changes by at a face of a wall, all of it at a closed door.
    doors:   whether each door is closed at the start, by name.
    storeys: of a building with levels.
    """

    ends_mm: np.ndarray
    weights: np.ndarray
    doors: dict[str, bool]
    storeys: tuple[_core.propagation.Storey, ...] = ()

    def core(self) -> _core.propagation.FaceSet:
        """Return these faces for the C++ core, with the doors in their initial states."""
        face_set = _core.propagation.FaceSet(self.ends_mm.tolist(), self.weights.tolist(), list(self.storeys))
        for name, closed in self.doors.items():
            face_set.set_active(self.door_face(name), closed)
        return face_set

    def door_face(self, name: str) -> int:
        """Return the index of a door's face. Raises: ValueError: no such door."""
        names = list(self.doors)
        if name not in names:
            raise ValueError(f"unknown door '{name}'; known: {', '.join(names) or 'none'}")
        return len(self.weights) - len(names) + names.index(name)


def radio_faces(plan: FloorPlan, radio: Radio) -> Faces:
    """Return the faces that attenuate radio, in units of 0.05 dB [dissertation, eq. 4 and Table 3].

    A ray loses the loss of each wall, block and pillar that it crosses, at any angle, half where it enters and half
    where it leaves; walls that touch or overlap are one wall with the highest of their losses, see `_faces`. The class
    follows from the thickness of a wall, or from the least width (over all directions) of a block or pillar without a
    thickness, in whole mm; over 80 cm it is ]60,80]. A loss in `radio.materials` replaces the class, and with
    `walls: material` the loss of the layers of a material of the plan does.

    Raises: ScenarioError: a material is unknown.
    """
    half_losses = tuple(
        _wall_units(plan, radio, solid.element) // 2 if radio.pillars or solid.kind != "pillar" else 0
        for solid in _static_solids(plan)
    )
    door_loss_db = {"normal": radio.door_loss_db, "fireproof": radio.fireproof_door_loss_db}
    floors = tuple(_floor_units(plan, radio, level) for level in plan.levels)
    return _faces(plan, half_losses, tuple(_units(door_loss_db[door.kind]) for door in plan.doors), floors)


def voice_faces(plan: FloorPlan, floor_units: int = 0) -> Faces:
    """Return the faces that attenuate voices, in halves of K in eq. (7): 1 per face of a solid, 2 per closed door.

    Args: floor_units: of each floor between two levels.
    """
    floors = (floor_units,) * len(plan.levels)
    return _faces(plan, (1,) * len(_static_solids(plan)), (2,) * len(plan.doors), floors)


def thickness_faces(plan: FloorPlan, floor_units: int = 0) -> Faces:
    """Return the faces that attenuate voices by thickness d [dissertation, eq. 5], in halves of a mm.

    d is the thickness that determines the class for radio, at any angle; for a closed door that of its leaf.
    Args: floor_units: of each floor between two levels.
    """
    return _faces(
        plan,
        tuple(_thickness_mm(solid.element) for solid in _static_solids(plan)),
        tuple(2 * _thickness_mm(door) for door in plan.doors),
        (floor_units,) * len(plan.levels),
    )


def storeys(plan: FloorPlan, floor_units: Sequence[int]) -> tuple[_core.propagation.Storey, ...]:
    """Return the levels of a plan for the C++ core. Args: floor_units: of the floor of each; -1: counted."""

    def to_mm(point: Point) -> tuple[int, int]:
        x, y = _whole(np.array(point) * MM_PER_M).astype(int).tolist()
        return x, y

    return tuple(
        _core.propagation.Storey(
            least_mm=to_mm(level.bounds.min),
            most_mm=to_mm(level.bounds.max),
            origin_mm=to_mm(level.origin),
            floor_mm=round(level.elevation_m * MM_PER_M),
            ceiling_mm=round((level.elevation_m + ceiling_height_m(plan.levels, level)) * MM_PER_M),
            floor_weight=units,
            openings_mm=[
                list(map(to_mm, hole.polygon)) for hole in plan.openings if level.bounds.contains(hole.polygon[0])
            ],
        )
        for level, units in zip(plan.levels, floor_units, strict=True)
    )


def material_faces(plan: FloorPlan, voice: Voice) -> Faces:
    """Return the faces that attenuate voices by the mass of their material, in units of 0.05 dB.

    Elements without a material of the plan, and closed doors, lose `voice.wall_loss_db`, and floors without one
    `voice.floor_loss_db`.
    """
    losses_db = {one.name: mass_law_loss_db(one.layers, voice.frequency_hz) for one in plan.materials}
    materials = [None if isinstance(e := solid.element, Door) else e.material for solid in _static_solids(plan)]
    half_losses = tuple(_units(losses_db.get(name or "", voice.wall_loss_db)) // 2 for name in materials)
    floors = tuple(_units(losses_db.get(level.floor_material or "", voice.floor_loss_db)) for level in plan.levels)
    return _faces(plan, half_losses, (_units(voice.wall_loss_db),) * len(plan.doors), floors)


def _static_solids(plan: FloorPlan) -> list[Solid]:
    return [solid for solid in solids(plan) if solid.kind != "door"]


# Shared by all trials on one plan: the garage takes some 20 ms.
@functools.lru_cache(maxsize=16)
def _faces(
    plan: FloorPlan, weights: tuple[int, ...], door_weights: tuple[int, ...], floor_weights: tuple[int, ...]
) -> Faces:
    """Return the faces of a plan.

    At each place, walls have the highest of their losses. A ray loses half of each change of it, so walls that touch
    or overlap are one wall, also at a corner. Blocks with a thickness are walls: an imported image is cut into them. A
    pillar, or a block without a thickness, loses its own in addition.

    Args: weights: half of the loss of each static solid, 0 if it does not attenuate.  door_weights: of its doors.
          floor_weights: of the floors of its levels, see `storeys`.
    """
    static = list(enumerate(zip(_static_solids(plan), weights, strict=True)))
    walls = {i: weight for i, (solid, weight) in static if weight > 0 and _is_wall(solid)}
    others = {i: weight for i, (solid, weight) in static if weight > 0 and not _is_wall(solid)}
    parts = [_separate_outlines(plan, others)]
    below = 0
    for level in sorted(set(walls.values())):  # the changes at the outline of all walls of so high a loss
        outline_mm = _union_outline(plan, tuple(i for i, weight in walls.items() if weight >= level))
        parts.append((outline_mm, np.full(len(outline_mm), level - below, dtype=np.int32)))
        below = level
    ends_mm, face_weights = _merged(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
    door_ends_mm = np.array([(*door.start, *door.end) for door in plan.doors]).reshape(-1, 4) * MM_PER_M
    all_ends_mm = np.vstack([ends_mm, _whole(door_ends_mm).astype(np.int64)])
    all_weights = np.concatenate([face_weights, np.array(door_weights, dtype=np.int32)])
    all_ends_mm.flags.writeable = all_weights.flags.writeable = False
    doors = {door.name: door.closed for door in plan.doors}
    return Faces(all_ends_mm, all_weights, doors, storeys(plan, floor_weights))


def _is_wall(solid: Solid) -> bool:
    return solid.kind != "pillar" and solid.element.thickness_m is not None


def _snapped(plan: FloorPlan, static: Sequence[int]) -> np.ndarray:
    """Return some of the static solids in whole millimetres; those without an area are empty."""
    polygons = footprints(_static_solids(plan))[list(static)]
    in_mm = shapely.transform(polygons, lambda points_m: _whole(points_m * MM_PER_M))
    return np.asarray(shapely.set_precision(in_mm, 1.0))


def _separate_outlines(plan: FloorPlan, weights: Mapping[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return ends [mm] and weights of the outlines of static solids, each of which counts for itself."""
    ends_mm, _, solid = _edges(shapely.orient_polygons(_snapped(plan, list(weights))))
    return ends_mm, np.array(list(weights.values()), dtype=np.int32)[solid]


@functools.lru_cache(maxsize=16)  # radio and voice have the same outline of all walls
def _union_outline(plan: FloorPlan, static: tuple[int, ...]) -> np.ndarray:
    """Return the ends [mm] of the outline of the union of static solids, its crossings rounded outwards."""
    snapped = _snapped(plan, static)
    edges_mm, _, _ = _edges(snapped)
    if np.all(np.any(edges_mm[:, :2] == edges_mm[:, 2:], axis=1)):
        # Crossings are whole already; a union that rounds takes four times as long.
        union = shapely.union_all(shapely.set_precision(snapped, 0.0))
    else:
        union = shapely.union_all(snapped, grid_size=1.0)
    ends_mm, ring, _ = _edges(shapely.orient_polygons(union))
    rounded_mm = round_outwards(ends_mm, ring, edges_mm)
    return rounded_mm[np.any(rounded_mm[:, :2] != rounded_mm[:, 2:], axis=1)]


def _merged(ends_mm: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces with those in one place merged, in order; so an outline of several levels stays one ring."""
    backwards = (ends_mm[:, 0] > ends_mm[:, 2]) | ((ends_mm[:, 0] == ends_mm[:, 2]) & (ends_mm[:, 1] > ends_mm[:, 3]))
    places = np.where(backwards[:, None], ends_mm[:, [2, 3, 0, 1]], ends_mm)
    _, first, same = np.unique(places, axis=0, return_index=True, return_inverse=True)
    sums = np.zeros(len(first), dtype=np.int32)
    np.add.at(sums, same.reshape(-1), weights)
    in_order = np.argsort(first)
    return ends_mm[first[in_order]], sums[in_order]


def _edges(geometry: shapely.Geometry | np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the edges of polygons (int64, shape (n, 4) [mm]), and the indices of ring and geometry of each."""
    rings, geometry_of_ring = shapely.get_parts(shapely.boundary(geometry), return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    points_mm = np.rint(points).astype(np.int64)
    joined = np.flatnonzero(ring[:-1] == ring[1:])
    return np.hstack([points_mm[joined], points_mm[joined + 1]]), ring[joined], geometry_of_ring[ring[joined]]


def _wall_units(plan: FloorPlan, radio: Radio, element: Wall | Block | Door) -> int:
    assert not isinstance(element, Door)
    if element.material is not None:
        units = _material_units(plan, radio, f"{element.name}.material", element.material)
        if units is not None:
            return units
    return _units(radio.wall_loss_db[_loss_class(element)])


def _material_units(plan: FloorPlan, radio: Radio, key: str, name: str) -> int | None:
    """Return the loss of a material; None: `radio.walls` does not read its layers. Raises: ScenarioError: unknown."""
    if name in radio.materials:
        return _units(radio.materials[name])
    layers = {material.name: material.layers for material in plan.materials}
    if name not in layers:
        known = ", ".join([*radio.materials, *layers]) or "none"
        place = f"{plan.name}: {key}: '{name}'"
        raise ScenarioError(f"{place} is neither in radio.materials nor in the plan's materials ({known})")
    return _units(wall_loss_db(layers[name], radio.frequency_mhz)) if radio.walls == "material" else None


def _floor_units(plan: FloorPlan, radio: Radio, level: Level) -> int:
    name = level.floor_material
    units = None if name is None else _material_units(plan, radio, f"levels {level.name}.floor_material", name)
    return _COUNTED if units is None else units


def _loss_class(element: Wall | Block) -> int:
    """Return the class of Table 3 that a thickness belongs to, from 0."""
    thickness_mm = _thickness_mm(element)
    return sum(thickness_mm > limit_mm for limit_mm in _CLASS_LIMITS_MM)


def _thickness_mm(element: Wall | Block | Door) -> int:
    thickness_m = element.thickness_m
    if thickness_m is None:
        assert isinstance(element, Block)
        thickness_m = _least_width_m(element.polygon)
    return int(_whole(thickness_m * MM_PER_M))


def _whole(values: np.ndarray | float) -> np.ndarray:
    """Return whole numbers: halves, within 1e-6 for rounding errors, go away from zero, as in the C++ core."""
    return np.asarray(np.trunc(values + np.copysign(0.5 + _HALF_TOLERANCE, values)))


def _units(loss_db: float) -> int:
    return round(loss_db * UNITS_PER_DB)


# Cached for the next trial: the pillars of the garage take 2 ms.
@functools.lru_cache(maxsize=4096)
def _least_width_m(polygon: tuple[tuple[float, float], ...]) -> float:
    return float(shapely.minimum_width(shapely.Polygon(polygon)).length)
