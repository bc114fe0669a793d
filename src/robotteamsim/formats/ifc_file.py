"""What an IFC file contains of a building: storeys, what blocks robots, openings and doors, as ifcopenshell 0.9 has it.

The package ifcopenshell is imported where it is used, because it belongs to an extra.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.ifc_shapes import Mesh
from robotteamsim.scenario.yaml_text import is_file
from robotteamsim.user_files import open_regular
from robotteamsim.wording import counted, printable

if TYPE_CHECKING:
    import ifcopenshell

Entity = Any
"""An instance of IFC, such as a wall; ifcopenshell gives its attributes by name."""

MOST_BYTES = 256 * 2**20
"""Of a file. It needs some 20 times its size while it is read."""

MOST_SOLIDS = 100_000
"""Walls, columns, panels, openings, doors, parts of stairs and slabs of all storeys."""

_END = b"END-ISO-10303-21;"
_FAR_M, _FARTHEST_M = 1e4, 1e8
"""Buildings farther away are moved to [0, 0]; and the farthest that can be read."""

_NAME_CHARACTERS = 60
"""Of storeys; the names of what is on them begin so in the plan."""

_BLOCKING = "IfcWall", "IfcColumn", "IfcCurtainWall", "IfcPlate", "IfcMember"
_RISES = {"IfcStair": "stairs", "IfcStairFlight": "stairs", "IfcRamp": "ramp", "IfcRampFlight": "ramp"}
_FLIGHTS = "IfcStairFlight", "IfcRampFlight"
_DRAWN = (
    *_BLOCKING,
    *_FLIGHTS,
    "IfcBuildingElementPart",
    "IfcDoor",
    "IfcWindow",
    "IfcOpeningElement",
    "IfcElementAssembly",
)


class Opening(NamedTuple):
    """A hole in a wall. owner: id of the wall.  fillings: doors and windows in it.  mesh: None if it cannot be read."""

    owner: int
    fillings: tuple[Entity, ...]
    mesh: Mesh | None

    @property
    def doors(self) -> list[Entity]:
        """The doors in it."""
        return [filling for filling in self.fillings if filling.is_a("IfcDoor")]


class Solid(NamedTuple):
    """What blocks robots: an element, that which it is part of (such as a curtain wall), and its surface."""

    element: Entity
    whole: Entity
    mesh: Mesh


class Rise(NamedTuple):
    """Stairs, a ramp or a lift. kind: such a word.  meshes: of its flights, landings and stringers, or of its cabin."""

    element: Entity
    kind: str
    meshes: tuple[Mesh, ...]

    @property
    def text(self) -> str:
        """Its id and class, for notes."""
        return f"#{self.element.id()} ({self.element.is_a()})"


class Storey(NamedTuple):
    """A storey: its name, its height in the file, and the entity."""

    name: str
    floor_m: float
    entity: Entity


class IfcBuilding:
    """A building as solids, openings, doors and what leads from storey to storey, in metres.

    storeys:  by name, the lowest first.
    solids:   what blocks robots, of all storeys.
    openings: in them.
    doors:    all doors; bodies: the surface of those that do not fill an opening alone.
    rises:    stairs, ramps and lifts.
    slabs:    floors by id, if there are such; parts of stairs are none.
    scale_m:  of lengths in attributes.
    shift_m:  place of [0, 0] in the file, shape (2,).
    notes:    what is doubtful about the file.
    """

    def __init__(self, path: Path) -> None:
        """Read a file. Raises: ScenarioError: one line with file and entity."""
        from ifcopenshell.util.unit import calculate_unit_scale, get_project_unit

        self._path, self._file = path, _opened(path)
        _check_loops(path, self._file)
        self.shift_m = np.zeros(2)
        self.notes: list[str] = []
        self.scale_m = float(calculate_unit_scale(self._file))
        if get_project_unit(self._file, "LENGTHUNIT") is None or not 0.0 < self.scale_m < _FARTHEST_M:
            raise ScenarioError(f"{path}: has no unit of length (IfcProject.UnitsInContext)")
        self.doors: list[Entity] = self._file.by_type("IfcDoor")
        self._read_meshes()
        self.storeys = self._storeys()

    def _read_meshes(self) -> None:
        """Read solids, openings, bodies of doors that do not fill an opening alone, stairs, ramps, lifts and slabs."""
        windows = [window for window in self._file.by_type("IfcWindow") if not window.FillsVoids]
        blocking = {
            one.id(): one for name in (*_BLOCKING, "IfcBuildingElementPart") for one in self._file.by_type(name)
        }
        blocking |= {one.id(): one for one in windows}
        wholes = {id_: _whole(one) for id_, one in blocking.items()}
        blocking = {id_: one for id_, one in blocking.items() if _blocks(wholes[id_])}
        voids = [(relation.RelatedOpeningElement, relation) for relation in self._file.by_type("IfcRelVoidsElement")]
        fillings = {hole.id(): tuple(one.RelatedBuildingElement for one in hole.HasFillings) for hole, _ in voids}
        holes = [hole for hole, _ in voids]
        alone = {one.id() for some in fillings.values() if len(some) == 1 for one in some}
        with_body = [door for door in self.doors if door.id() not in alone]
        rises = self._rises()
        of_rises = {one.id(): one for _, _, parts in rises for one in parts}
        slabs = [one for one in self._file.by_type("IfcSlab") if rises and one.id() not in of_rises]
        meshes = self._meshes([*blocking.values(), *holes, *with_body, *of_rises.values(), *slabs])
        self.rises = [
            Rise(one, kind, tuple(meshes[part.id()] for part in parts if part.id() in meshes))
            for one, kind, parts in rises
        ]
        self.slabs = {one.id(): meshes[one.id()] for one in slabs if one.id() in meshes}
        self.solids = [Solid(one, wholes[id_], meshes[id_]) for id_, one in blocking.items() if id_ in meshes]
        self.openings = [
            Opening(relation.RelatingBuildingElement.id(), fillings[hole.id()], meshes.get(hole.id()))
            for hole, relation in voids
        ]
        self.bodies = {door.id(): meshes[door.id()] for door in with_body if door.id() in meshes}
        lost = [one for id_, one in blocking.items() if id_ not in meshes and not one.IsDecomposedBy]
        lost += [one for one in holes if one.id() not in meshes]
        if lost:
            self.notes.append(f"without a shape that can be read, left out: {listed(lost)}")
        if not self.solids:
            raise ScenarioError(f"{self._path}: has no walls, so there is no building to import")

    def _rises(self) -> list[tuple[Entity, str, list[Entity]]]:
        """Return stairs, ramps and lifts with their kinds and parts; railings are none of them."""
        from ifcopenshell.util.element import get_decomposition, get_predefined_type

        found: dict[int, tuple[Entity, str, list[Entity]]] = {}
        for name, kind in _RISES.items():
            for one in self._file.by_type(name):
                whole = _whole(one)
                whole = whole if any(map(whole.is_a, _RISES)) else one
                parts = [part for part in (whole, *get_decomposition(whole)) if part.is_a("IfcElement")]
                parts = [part for part in parts if not part.is_a("IfcRailing") and not part.is_a("IfcFeatureElement")]
                found.setdefault(whole.id(), (whole, kind, parts))
        for one in self._file.by_type("IfcTransportElement"):
            if "ELEVATOR" in (getattr(one, "OperationType", None), get_predefined_type(one)):
                found[one.id()] = (one, "lift", [one])
        return list(found.values())

    def _meshes(self, elements: list[Entity]) -> dict[int, Mesh]:
        """Return surfaces in the map by id, without openings; those that cannot be made are missing.

        Raises: ScenarioError: one is not finite, or there are too many.
        """
        import ifcopenshell.geom
        from ifcopenshell.util.shape import get_faces, get_faces_representation_item_ids, get_vertices

        if len(elements) > MOST_SOLIDS:
            text = f"{len(elements)} walls, openings, stairs and other parts; expected at most {MOST_SOLIDS}"
            raise ScenarioError(f"{self._path}: {text}")
        settings = ifcopenshell.geom.settings()
        settings.set("use-world-coords", True)
        settings.set("disable-opening-subtractions", True)
        meshes: dict[int, Mesh] = {}
        shaped = [one for one in elements if one.Representation]
        if not shaped:
            return {}
        try:
            # With a log of its own: else messages collect in that of the process.
            shapes = ifcopenshell.geom.iterator(settings, self._file, 1, shaped, logger=ifcopenshell.logger())
        except RuntimeError as error:
            raise ScenarioError(f"{self._path}: its shapes cannot be read: {printable(str(error))}") from None
        for shape in shapes:
            corners = get_vertices(shape.geometry)[get_faces(shape.geometry)]
            if not np.isfinite(corners).all() or np.abs(corners).max(initial=0.0) > _FARTHEST_M:
                raise ScenarioError(
                    f"{self._path}: #{shape.id}: coordinates that are not finite, or beyond {_FARTHEST_M:g} m"
                )
            if len(corners):
                meshes[shape.id] = Mesh(corners, get_faces_representation_item_ids(shape.geometry).copy())
        return self._moved(meshes)

    def _moved(self, meshes: dict[int, Mesh]) -> dict[int, Mesh]:
        """Return meshes near [0, 0]: the coordinates of surveys would cost digits."""
        places = np.array([mesh.corners[..., :2].min(axis=(0, 1)) for mesh in meshes.values()])
        if not meshes or np.abs(places).max() <= _FAR_M:
            return meshes
        self.shift_m = np.floor(np.median(places, axis=0))
        moved = np.array([*self.shift_m, 0.0])
        return {id_: Mesh(mesh.corners - moved, mesh.items) for id_, mesh in meshes.items()}

    def _storeys(self) -> dict[str, Storey]:
        """Return the storeys by name, the lowest first. Raises: ScenarioError: there are none."""
        found = self._file.by_type("IfcBuildingStorey")
        if not found:
            raise ScenarioError(f"{self._path}: has no storeys (IfcBuildingStorey)")
        names = {one.id(): printable((one.Name or "").strip())[:_NAME_CHARACTERS] or f"#{one.id()}" for one in found}
        often = Counter(names.values())
        storeys = []
        for one in found:
            name = names[one.id()]
            storeys.append(Storey(name if often[name] == 1 else f"{name} #{one.id()}", self._floor_m(one), one))
        storeys.sort(key=lambda storey: (storey.floor_m, storey.entity.id()))
        return {storey.name: storey for storey in storeys}

    def _floor_m(self, storey: Entity) -> float:
        """Return the height of a storey's floor in the world.

        Its placement and its Elevation, which is above the building's zero, may differ, and either may be missing. Then
        that is right which is nearer to the walls that are listed in it.
        """
        from ifcopenshell.util.element import get_aggregate

        candidates_m = [] if storey.ObjectPlacement is None else [self._height_m(storey)]
        if storey.Elevation is not None:
            building = get_aggregate(storey)
            base_m = self._height_m(building) if building and building.ObjectPlacement else 0.0
            candidates_m.append(base_m + self.scale_m * storey.Elevation)
        candidates_m = [one for one in candidates_m if abs(one) < _FARTHEST_M]
        listed = {one.id() for relation in storey.ContainsElements for one in relation.RelatedElements}
        lows_m = [solid.mesh.low_m for solid in self.solids if {solid.element.id(), solid.whole.id()} & listed]
        if not lows_m:
            return candidates_m[0] if candidates_m else 0.0
        low_m = float(np.median(lows_m))
        floor_m = min(candidates_m, key=lambda one: abs(one - low_m), default=low_m)
        if not candidates_m or max(candidates_m) - min(candidates_m) > 1e-3:
            self.notes.append(f"storey #{storey.id()}: its floor is taken at {floor_m:g} m, near that of its walls")
        return floor_m

    def _height_m(self, entity: Entity) -> float:
        from ifcopenshell.util.placement import get_local_placement

        return self.scale_m * float(get_local_placement(entity.ObjectPlacement)[2, 3])

    def left_out(self, storey: Storey) -> Counter[str]:
        """Return how many elements of each other class are listed in a storey."""
        from ifcopenshell.util.element import get_decomposition

        drawn = {rise.element.id() for rise in self.rises if rise.meshes}
        return Counter(
            one.is_a()
            for one in get_decomposition(storey.entity)
            if one.is_a("IfcElement") and not any(map(one.is_a, _DRAWN)) and one.id() not in drawn
        )


def _opened(path: Path) -> ifcopenshell.file:
    """Return the contents of a file. Raises: ScenarioError: it cannot be read as a whole."""
    import ifcopenshell

    if not is_file(path):
        raise ScenarioError(f"{path}: there is no such file")
    if (size := path.stat().st_size) > MOST_BYTES:
        raise ScenarioError(f"{path}: {size / 2**20:.0f} MiB; expected at most {MOST_BYTES // 2**20}")
    log = ifcopenshell.logger()
    log.output_format(log.FMT_INMEMORY)
    failure = ""
    try:
        with open_regular(path) as file:
            begin = file.read(4096)
            file.seek(max(size - 4096, 0))
            end = file.read()
        if b"ISO-10303-21;" not in begin:
            raise ScenarioError(f"{path}: is not an IFC file: it does not begin with ISO-10303-21")
        if _END not in end:
            raise ScenarioError(f"{path}: is not complete: it does not end with {_END.decode()}")
        found = ifcopenshell.open(path, ".ifc", logger=log)
    except (OSError, MemoryError, ifcopenshell.Error, ifcopenshell.SchemaError) as error:
        failure = getattr(error, "strerror", None) or str(error) or "out of memory"
    errors = [printable(message.message) for message in log if message.severity >= log.LOG_ERROR]
    if failure or errors:
        more = f", and {counted(len(errors) - 1, 'further mistake')}" if len(errors) > 1 else ""
        raise ScenarioError(f"{path}: cannot be read as IFC: {errors[0] if errors else printable(failure)}{more}")
    return found


_PART_OF = (
    ("IfcRelAggregates", "RelatingObject", "RelatedObjects"),
    ("IfcRelNests", "RelatingObject", "RelatedObjects"),
    ("IfcRelContainedInSpatialStructure", "RelatingStructure", "RelatedElements"),
    ("IfcRelVoidsElement", "RelatingBuildingElement", "RelatedOpeningElement"),
    ("IfcRelFillsElement", "RelatingOpeningElement", "RelatedBuildingElement"),
)
"""Relations with the names of their attributes: the whole, and what is part of it."""


def _check_loops(path: Path, file: ifcopenshell.file) -> None:
    """Raise an error for what is part of itself, or placed relative to itself: ifcopenshell 0.9.0 hangs or crashes."""
    found: dict[int, set[int]] = {}
    for name, whole, parts in _PART_OF:
        for relation in file.by_type(name):
            some = getattr(relation, parts)
            for part in some if isinstance(some, tuple) else (some,):
                found.setdefault(part.id(), set()).add(getattr(relation, whole).id())
    for placement in file.by_type("IfcLocalPlacement"):
        if placement.PlacementRelTo is not None:
            found.setdefault(placement.id(), set()).add(placement.PlacementRelTo.id())
    try:
        TopologicalSorter(found).prepare()
    except CycleError as error:
        ids = ", ".join(f"#{id_}" for id_ in sorted(set(error.args[1])))
        raise ScenarioError(f"{path}: {ids}: part of itself, or placed relative to itself") from None


def schema_mistakes(path: Path) -> list[str]:
    """Return where a file breaks the schema of IFC, such as "#44.Axis". Many exports do somewhere."""
    from ifcopenshell.validate import json_logger, validate

    found = json_logger()
    validate(_opened(path), found)
    places = [(one.get("instance"), one.get("attribute")) for one in found.statements]
    return [f"#{one.id()}.{attribute.rpartition('.')[2]}" for one, attribute in places if one and attribute]


def _whole(element: Entity) -> Entity:
    """Return that which an element is part of, such as its curtain wall, or itself."""
    from ifcopenshell.util.element import get_aggregate

    whole = get_aggregate(element)
    if whole is None or not whole.is_a("IfcElement") or whole.is_a("IfcElementAssembly"):
        return element
    return _whole(whole)


def _blocks(whole: Entity) -> bool:
    """Whether a whole blocks robots; parts of stairs, railings and roofs are none of our walls."""
    return any(map(whole.is_a, (*_BLOCKING, "IfcWindow")))


def _doors(fillings: Iterable[Entity]) -> list[Entity]:
    return [filling for filling in fillings if filling.is_a("IfcDoor")]


def listed(entities: list[Entity]) -> str:
    """Return how many entities of each class there are, and the first of each."""
    by_class: dict[str, list[Entity]] = {}
    for one in entities:
        by_class.setdefault(one.is_a(), []).append(one)

    def texts() -> Iterator[str]:
        for name, some in sorted(by_class.items()):
            ids = ", ".join(f"#{one.id()}" for one in some[:_MOST_NAMED])
            yield f"{len(some)} {name} ({ids}{', ...' if len(some) > _MOST_NAMED else ''})"

    return ", ".join(texts())


_MOST_NAMED = 5
