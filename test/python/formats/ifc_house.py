"""Small IFC files, written with ifcopenshell's own API."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import ifcopenshell.api.aggregate
import ifcopenshell.api.context
import ifcopenshell.api.feature
import ifcopenshell.api.geometry
import ifcopenshell.api.material
import ifcopenshell.api.owner
import ifcopenshell.api.project
import ifcopenshell.api.pset
import ifcopenshell.api.root
import ifcopenshell.api.spatial
import ifcopenshell.api.type
import ifcopenshell.api.unit
import numpy as np
import shapely
from scipy.spatial import ConvexHull

from robotteamsim.formats import Imported
from robotteamsim.formats.ifc import IfcImporter
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import solids

api = ifcopenshell.api
UNITS = "MILLIMETERS", "METERS", "INCHES", "FEET"
Entity = Any


def placed(x: float, y: float, z: float, turn_rad: float = 0.0) -> np.ndarray:
    """Return a pose; float64, shape (4, 4) [m]."""
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    return np.array([[cos, -sin, 0.0, x], [sin, cos, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]])


class House:
    """A building whose parts are given in metres; files may have other units."""

    def __init__(self, schema: str = "IFC4", unit: str | None = "MILLIMETERS") -> None:
        self.file = api.project.create_file(version=schema)
        if schema == "IFC2X3":  # needs an author
            person, firm = api.owner.add_person(self.file), api.owner.add_organisation(self.file)
            api.owner.add_person_and_organisation(self.file, person=person, organisation=firm)
            api.owner.add_application(self.file, application_developer=firm)
        project = self._entity("IfcProject")
        if unit:
            api.unit.assign_unit(self.file, length={"is_metric": unit.endswith("METERS"), "raw": unit})
        model = api.context.add_context(self.file, context_type="Model")
        self._body = api.context.add_context(
            self.file, context_type="Model", context_identifier="Body", target_view="MODEL_VIEW", parent=model
        )
        self.site, self.building = self._entity("IfcSite"), self._entity("IfcBuilding")
        for whole, part in ((project, self.site), (self.site, self.building)):
            api.aggregate.assign_object(self.file, products=[part], relating_object=whole)
        self.scale_m = ifcopenshell.util.unit.calculate_unit_scale(self.file)
        self.storeys: list[Entity] = []

    def _entity(self, ifc_class: str, name: str | None = None) -> Entity:
        return api.root.create_entity(self.file, ifc_class=ifc_class, name=name)

    def storey(self, name: str | None, floor_m: float, *, elevation: bool = True, placement: bool = True) -> Entity:
        """Add a storey; what is added next is listed in it."""
        storey = self._entity("IfcBuildingStorey", name)
        api.aggregate.assign_object(self.file, products=[storey], relating_object=self.building)
        storey.Elevation = floor_m / self.scale_m if elevation else None
        if placement:
            api.geometry.edit_object_placement(self.file, product=storey, matrix=placed(0.0, 0.0, floor_m))
        self.storeys.append(storey)
        return storey

    def add(self, ifc_class: str, shape: Entity | None, pose: np.ndarray, *, of: Entity | None = None) -> Entity:
        """Add an element to a storey or to the site, or to that which it is part of; by default, to the last storey."""
        element = self._entity(ifc_class)
        if shape is not None:
            api.geometry.assign_representation(self.file, product=element, representation=shape)
        api.geometry.edit_object_placement(self.file, product=element, matrix=pose)
        if of is not None and of.is_a("IfcElement"):
            api.aggregate.assign_object(self.file, products=[element], relating_object=of)
        else:
            where = of or (self.storeys[-1] if self.storeys else self.site)
            api.spatial.assign_container(self.file, products=[element], relating_structure=where)
        return element

    def _box(self, length: float, width: float, height: float) -> Entity:
        return api.geometry.add_wall_representation(
            self.file, context=self._body, length=length, height=height, thickness=width
        )

    def wall(
        self,
        start: Sequence[float],
        end: Sequence[float],
        thickness: float = 0.2,
        low: float = 0.0,
        high: float = 3.0,
        *,
        ifc_class: str = "IfcWall",
        of: Entity | None = None,
    ) -> Entity:
        """Add a box around a centre line."""
        dx, dy = np.subtract(end, start)
        length, turn_rad = math.hypot(dx, dy), math.atan2(dy, dx)
        x, y = start[0] + 0.5 * thickness * math.sin(turn_rad), start[1] - 0.5 * thickness * math.cos(turn_rad)
        return self.add(ifc_class, self._box(length, thickness, high - low), placed(x, y, low, turn_rad), of=of)

    def prism(
        self,
        ifc_class: str,
        rings: Sequence[Sequence[tuple[float, float]]],
        low: float = 0.0,
        high: float = 3.0,
        of: Entity | None = None,
    ) -> Entity:
        """Add an outline with holes, extruded."""

        def curve(ring: Sequence[tuple[float, float]]) -> Entity:
            points = [tuple(np.array(point) / self.scale_m) for point in (*ring, ring[0])]
            points = [self.file.createIfcCartesianPoint(tuple(map(float, point))) for point in points]
            return self.file.createIfcPolyline(points)

        outer, *holes = map(curve, rings)
        kind = "IfcArbitraryProfileDefWithVoids" if holes else "IfcArbitraryClosedProfileDef"
        profile = self.file.create_entity(kind, ProfileType="AREA", OuterCurve=outer)
        if holes:
            profile.InnerCurves = holes
        return self._extruded(ifc_class, profile, low, high, (0.0, 0.0), of)

    def solids(
        self, ifc_class: str, solids: Sequence[np.ndarray], of: Entity | None = None, *, inside_out: bool = False
    ) -> Entity:
        """Add an element of convex solids. Args: solids: float64, shape (n, 3), corners [m]."""
        faces = []
        for corners in solids:
            hull = ConvexHull(corners)
            outwards = np.einsum("ij,ij->i", np.cross(*_sides(corners[hull.simplices])), hull.equations[:, :3]) > 0.0
            faces.append(
                [
                    side if out != inside_out else side[::-1]
                    for side, out in zip(hull.simplices.tolist(), outwards, strict=True)
                ]
            )
        shape = api.geometry.add_mesh_representation(
            self.file,
            context=self._body,
            vertices=[one.tolist() for one in solids],
            faces=faces,
            force_faceted_brep=True,
        )
        return self.add(ifc_class, shape, placed(0.0, 0.0, 0.0), of=of)

    def flight(
        self,
        start: Sequence[float],
        along: Sequence[float],
        num_treads: int,
        width: float = 1.0,
        *,
        riser: float = 0.2,
        tread: float = 0.25,
        of: Entity | None = None,
        ifc_class: str = "IfcStairFlight",
        inside_out: bool = False,
    ) -> Entity:
        """Add steps of 5 cm. Args: start: middle of the front of the first one, on the floor.  along: unit vector."""
        (x, y, low), (u, v) = start, along
        treads = []
        for i in range(num_treads):
            ends = [(x + at * u, y + at * v) for at in (i * tread, (i + 1) * tread)]
            sides = [(px - side * v, py + side * u) for px, py in ends for side in (-0.5 * width, 0.5 * width)]
            top = low + (i + 1) * riser
            treads.append(np.array([(*side, z) for side in sides for z in (top - 0.05, top)]))
        return self.solids(ifc_class, treads, of, inside_out=inside_out)

    def round_column(self, x: float, y: float, radius: float, wall: float | None = None) -> Entity:
        """Add a column; wall: thickness of a pipe."""
        kind = "IfcCircleHollowProfileDef" if wall else "IfcCircleProfileDef"
        centre = self.file.createIfcAxis2Placement2D(self.file.createIfcCartesianPoint((0.0, 0.0)))
        profile = self.file.create_entity(kind, ProfileType="AREA", Position=centre, Radius=radius / self.scale_m)
        if wall:
            profile.WallThickness = wall / self.scale_m
        return self._extruded("IfcColumn", profile, 0.0, 3.0, (x, y), None)

    def _extruded(
        self, ifc_class: str, profile: Entity, low: float, high: float, at: tuple[float, float], of: Entity | None
    ) -> Entity:
        shape = api.geometry.add_profile_representation(
            self.file, context=self._body, profile=profile, depth=high - low, cardinal_point=None
        )
        return self.add(ifc_class, shape, placed(*at, low), of=of)

    def opening(
        self, wall: Entity, at: float, width: float, low: float = 0.0, high: float = 2.1, depth: float = 2.0
    ) -> Entity:
        """Add a hole from `at` along a wall; depth: across, on both sides of the wall's right face."""
        pose = self._pose(wall) @ placed(at, -0.5 * depth, 0.0)
        pose[2, 3] = low
        hole = self._entity("IfcOpeningElement")
        box = self._box(width, depth, high - low)
        api.geometry.assign_representation(self.file, product=hole, representation=box)
        api.geometry.edit_object_placement(self.file, product=hole, matrix=pose)
        api.feature.add_feature(self.file, feature=hole, element=wall)
        return hole

    def _pose(self, element: Entity) -> np.ndarray:
        pose = ifcopenshell.util.placement.get_local_placement(element.ObjectPlacement).copy()
        pose[:3, 3] *= self.scale_m
        return pose

    def filling(
        self,
        hole: Entity,
        ifc_class: str = "IfcDoor",
        operation: str | None = None,
        rating: str | None = None,
        body: tuple[float, float] | None = None,
    ) -> Entity:
        """Add a door or window to a hole; body: where its box begins and ends along the wall, from the hole."""
        element = self._entity(ifc_class)
        pose = self._pose(hole)
        if body is not None:
            box = self._box(body[1] - body[0], 0.05, 2.0)
            api.geometry.assign_representation(self.file, product=element, representation=box)
            pose = pose @ placed(body[0], 0.0, 0.0)
        api.geometry.edit_object_placement(self.file, product=element, matrix=pose)
        api.feature.add_filling(self.file, opening=hole, element=element)
        api.spatial.assign_container(self.file, products=[element], relating_structure=self.storeys[-1])
        if operation:
            name = "IfcDoorStyle" if self.file.schema == "IFC2X3" else "IfcDoorType"
            kind = self._entity(name)
            kind.OperationType = operation
            api.type.assign_type(self.file, related_objects=[element], relating_type=kind)
        if rating is not None:
            pset = api.pset.add_pset(self.file, product=element, name="Pset_DoorCommon")
            api.pset.edit_pset(self.file, pset=pset, properties={"FireRating": rating})
        return element

    def room(self, width: float = 6.0, depth: float = 4.0, low: float = 0.0, high: float = 3.0) -> list[Entity]:
        """Add four walls between the corners of a rectangle: south, east, north, west."""
        corners = [(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth)]
        return [
            self.wall(one, other, low=low, high=high)
            for one, other in zip(corners, corners[1:] + corners[:1], strict=True)
        ]

    def material(self, name: str | None) -> Entity | None:
        """Return a material."""
        return api.material.add_material(self.file, name=name) if name else None

    def layers(self, wall: Entity, layers: Sequence[tuple[str | None, float]], kind: str, name: str = "Wall") -> None:
        """Give a wall materials with thicknesses. Args: kind: a class of IFC."""
        if kind == "IfcMaterial":
            api.material.assign_material(self.file, products=[wall], material=self.material(layers[0][0]))
            return
        set_type = "IfcMaterialLayerSet" if kind == "IfcMaterialLayerSetUsage" else kind
        found = api.material.add_material_set(self.file, name=name, set_type=set_type)
        for material, thickness in layers:
            if set_type == "IfcMaterialLayerSet":
                layer = self.file.create_entity("IfcMaterialLayer", self.material(material), thickness / self.scale_m)
                found.MaterialLayers = (*(found.MaterialLayers or ()), layer)
            elif set_type == "IfcMaterialList":
                api.material.add_list_item(self.file, material_list=found, material=self.material(material))
            else:
                api.material.add_constituent(self.file, constituent_set=found, material=self.material(material))
        if kind == "IfcMaterialLayerSetUsage":
            found = self.file.create_entity(kind, found, "AXIS2", "POSITIVE", 0.0)
        self.file.create_entity(
            "IfcRelAssociatesMaterial",
            ifcopenshell.guid.new(),
            self.file.by_type("IfcOwnerHistory")[0] if self.file.schema == "IFC2X3" else None,
            RelatedObjects=[wall],
            RelatingMaterial=found,
        )

    def write(self, folder: Path) -> Path:
        """Write the file; return its path."""
        path = folder / "house.ifc"
        self.file.write(str(path))
        return path


def box(low: Sequence[float], high: Sequence[float]) -> np.ndarray:
    """Return the corners of a box; float64, shape (8, 3)."""
    return np.array([(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])


def _sides(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]


def read(folder: Path, house: House, **options: Any) -> Imported:
    """Return what is imported of a building."""
    return IfcImporter().read(house.write(folder), **options)


def solid(plan: FloorPlan) -> shapely.Geometry:
    """Return what is solid when all doors are open."""
    return shapely.union_all([one.polygon for one in solids(plan) if one.kind != "door"])


def opening_m(plan: FloorPlan, start: tuple[float, float], end: tuple[float, float]) -> float:
    """Return the free length of a line."""
    return float(shapely.LineString([start, end]).difference(solid(plan)).length)
