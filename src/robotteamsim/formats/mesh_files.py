"""Files of meshes: glTF, Wavefront OBJ and COLLADA."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import shapely

from robotteamsim import palette

if TYPE_CHECKING:  # packages of an extra
    import trimesh

_Y_UP = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
"""From z up to the axes of glTF: x to the right, y up, z to the viewer."""


@dataclass(frozen=True)
class Part:
    """A mesh of one material and colour, z up [m]."""

    name: str
    material: str
    colour: str
    mesh: trimesh.Trimesh

    @classmethod
    def of_prisms(
        cls,
        name: str,
        material: str,
        colour: str,
        prisms: Sequence[tuple[shapely.Polygon, tuple[float, float, float], float]],
    ) -> Part:
        """Return upright prisms as a mesh. Args: prisms: outlines, by how much each is moved, and heights [m]."""
        import trimesh

        meshes = []
        for outline, move_m, height_m in prisms:
            mesh = trimesh.creation.extrude_polygon(outline, height_m, engine="earcut")
            meshes.append(mesh.apply_translation(move_m))
        return cls(name, material, colour, cast("trimesh.Trimesh", trimesh.util.concatenate(meshes)))


def glb_of(parts: Sequence[Part]) -> bytes:
    """Return parts as a binary file of glTF 2.0, which has y up."""
    import trimesh

    scene = trimesh.Scene()
    for part in parts:
        material = trimesh.visual.material.PBRMaterial(
            name=part.material,
            baseColorFactor=[*palette.linear(part.colour), 1.0],
            metallicFactor=0.0,
            roughnessFactor=1.0,
        )
        _add(scene, part, material, _Y_UP)
    return bytes(scene.export(file_type="glb"))


def obj_of(parts: Sequence[Part], materials: str) -> tuple[str, str]:
    """Return parts as a Wavefront OBJ and its materials. Args: materials: name of their file."""
    import trimesh

    scene = trimesh.Scene()
    for part in parts:
        diffuse = [*palette.rgb(part.colour), 1.0]
        _add(scene, part, trimesh.visual.material.SimpleMaterial(name=part.material, diffuse=diffuse), np.eye(4))
    text, files = trimesh.exchange.obj.export_obj(scene, return_texture=True, mtl_name=materials, header=None)
    return text, files[materials].decode()


def _add(scene: trimesh.Scene, part: Part, material: Any, turn: np.ndarray) -> None:
    import trimesh

    mesh = trimesh.Trimesh(part.mesh.vertices, part.mesh.faces, process=False, metadata={"name": part.name})
    mesh.apply_transform(turn)
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    scene.add_geometry(mesh, node_name=part.name, geom_name=part.name)


def collada_of(parts: Sequence[Part]) -> bytes:
    """Return parts as a COLLADA file, with z up. Trimesh itself would lose their names and write that y is up."""
    import collada

    document = collada.Collada()
    document.assetInfo.upaxis = collada.asset.UP_AXIS.Z_UP
    nodes = []
    for number, part in enumerate(parts):
        colour = (*palette.rgb(part.colour), 1.0)
        effect = collada.material.Effect(f"effect{number}", [], "phong", diffuse=colour)
        material = collada.material.Material(f"material{number}", part.material, effect)
        document.effects.append(effect)
        document.materials.append(material)
        sources = [
            collada.source.FloatSource(f"{name}{number}", np.ravel(values), ("X", "Y", "Z"))
            for name, values in (("vertices", part.mesh.vertices), ("normals", part.mesh.face_normals))
        ]
        geometry = collada.geometry.Geometry(document, f"geometry{number}", part.name, sources)
        inputs = collada.source.InputList()
        inputs.addInput(0, "VERTEX", f"#vertices{number}")
        inputs.addInput(1, "NORMAL", f"#normals{number}")
        faces = part.mesh.faces
        indices = np.stack([faces, np.broadcast_to(np.arange(len(faces))[:, None], faces.shape)], axis=-1)
        geometry.primitives.append(geometry.createTriangleSet(indices.ravel(), inputs, part.material))
        document.geometries.append(geometry)
        uses = [collada.scene.MaterialNode(part.material, material, inputs=[])]
        shown = collada.scene.GeometryNode(geometry, uses)
        nodes.append(collada.scene.Node(f"node{number}", children=[shown], name=part.name))
    document.scenes.append(collada.scene.Scene("scene", nodes))
    document.scene = document.scenes[0]
    file = io.BytesIO()
    document.write(file)
    return file.getvalue()
