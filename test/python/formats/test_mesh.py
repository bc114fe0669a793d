"""Buildings as meshes, read again by trimesh and pycollada."""

from __future__ import annotations

import itertools
from pathlib import Path

import collada
import numpy as np
import pytest
import shapely
import trimesh

from robotteamsim import palette
from robotteamsim.cli import main
from robotteamsim.scenario import load_floor_plan
from robotteamsim.scenario.plan import solids

TWO_FLOORS = """
name: two floors
bounds: {min: [0, 0], max: [27, 10]}
levels:
  - {name: L1, bounds: {min: [0, 0], max: [12, 10]}, origin: [1, 1], elevation_m: 0.0}
  - {name: Obergeschoß 2, bounds: {min: [15, 0], max: [27, 10]}, origin: [16, 1], elevation_m: 3.0}
openings: [{name: well, polygon: [[17, 7], [19, 7], [19, 8], [17, 8]]}]
passages: [{name: lift, stops: [[2.5, 7.5], [17.5, 7.5]]}]
walls:
  - {name: high, from: [1, 1], to: [11, 1]}
  - {name: low, from: [6, 0.5], to: [6, 6], thickness_m: 0.4, height_m: 2.0}
  - {name: left, from: [17, 5], to: [19, 5]}
  - {name: right, from: [20, 5], to: [22, 5]}
blocks:
  - {name: core, polygon: [[2, 2], [2, 4], [3, 4], [3, 2]], height_m: 1.5}
  - {name: post, kind: pillar, polygon: [[24, 2], [24.3, 2], [24, 2.4]]}
doors: [{name: d, from: [19, 5], to: [20, 5], kind: fireproof, closed: true}]
"""
SECOND = "Obergeschoß 2"
VOLUMES = {  # areas by hand, times heights [m^3]
    "floor_L1": 120.0 * 0.2,
    "walls_L1": 10.0 * 0.2 * 2.6 + (5.5 * 0.4 - 0.4 * 0.2) * 2.0,  # where they cross, the higher one is
    "blocks_L1": 2.0 * 1.5,
    f"floor_{SECOND}": (120.0 - 2.0) * 0.2,
    f"walls_{SECOND}": 4.0 * 0.2 * 2.6,
    f"pillars_{SECOND}": 0.5 * 0.3 * 0.4 * 2.6,
    f"fireproof_doors_{SECOND}": 1.0 * 0.06 * 2.1,
}
TOP_M = {"walls_L1": 2.6, "blocks_L1": 1.5, f"walls_{SECOND}": 5.6, f"fireproof_doors_{SECOND}": 5.1}


def _export(folder: Path, plan: str, suffix: str, name: str = "plan") -> Path:
    (folder / f"{name}.yaml").write_text(plan, encoding="utf-8")
    words = ["plan", "export-mesh", f"{folder}/{name}.yaml", "--out", str(folder), "--format", suffix]
    assert main(words) == 0
    return folder / f"{name}.{suffix}"


def test_gltf_has_a_closed_mesh_for_each_kind_and_level_with_y_up(tmp_path: Path) -> None:
    scene = trimesh.load_scene(_export(tmp_path, TWO_FLOORS, "glb"))
    assert {name: mesh.volume for name, mesh in scene.geometry.items()} == pytest.approx(VOLUMES, rel=1e-5)
    assert all(mesh.is_watertight and mesh.is_winding_consistent for mesh in scene.geometry.values())
    assert scene.bounds == pytest.approx(np.array([[-1.0, -0.2, -9.0], [11.0, 5.6, 1.0]]))
    assert {name: scene.geometry[name].bounds[1][1] for name in TOP_M} == pytest.approx(TOP_M)
    # [24, 2] of the plan is [8, 1] from the origin of its level.
    low, high = scene.geometry[f"pillars_{SECOND}"].bounds
    assert [low, high] == [pytest.approx([8.0, 3.0, -1.4]), pytest.approx([8.3, 5.6, -1.0])]


def test_colours_of_gltf_are_linear(tmp_path: Path) -> None:
    scene = trimesh.load_scene(_export(tmp_path, TWO_FLOORS, "glb"))
    colour = scene.geometry["walls_L1"].visual.material.baseColorFactor[:3] / 255.0
    srgb = 1.055 * np.power(colour, 1.0 / 2.4) - 0.055  # IEC 61966-2-1
    assert srgb == pytest.approx(np.array(palette.rgb(palette.LIT_SOLIDS["wall"])), abs=0.005)


def test_obj_has_an_object_for_each_kind_and_level_with_z_up(tmp_path: Path) -> None:
    path = _export(tmp_path, TWO_FLOORS, "obj")
    lines = path.read_text(encoding="utf-8").splitlines()
    assert [line[2:] for line in lines if line.startswith("o ")] == list(VOLUMES)
    assert "mtllib two_floors.mtl" in lines
    scene = trimesh.load_scene(path)  # by materials
    assert scene.bounds == pytest.approx(np.array([[-1.0, -1.0, -0.2], [11.0, 9.0, 5.6]]))
    volumes = {name: scene.geometry[name].volume for name in ("floor", "walls")}
    expected = {name: VOLUMES[f"{name}_L1"] + VOLUMES[f"{name}_{SECOND}"] for name in volumes}
    assert volumes == pytest.approx(expected, rel=1e-6)
    assert all(mesh.is_watertight for mesh in scene.geometry.values())
    assert scene.geometry["pillars"].visual.material.diffuse[:3] / 255.0 == pytest.approx(
        np.array(palette.rgb(palette.LIT_SOLIDS["pillar"])), abs=0.002
    )


def test_collada_has_names_colours_and_z_up(tmp_path: Path) -> None:
    path = _export(tmp_path, TWO_FLOORS, "dae")
    document = collada.Collada(str(path))
    assert document.assetInfo.upaxis == "Z_UP"
    assert [node.name for node in document.scene.nodes] == list(VOLUMES)
    shown = document.scene.nodes[1].children[0]
    assert shown.materials[0].target.effect.diffuse[:3] == pytest.approx(palette.rgb(palette.LIT_SOLIDS["wall"]))
    (triangles,) = shown.geometry.primitives
    corners = triangles.vertex[triangles.vertex_index]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = triangles.normal[triangles.normal_index]
    assert normals[:, 0] == pytest.approx(across / np.linalg.norm(across, axis=1)[:, None], abs=1e-6)
    meshes = list(trimesh.load_scene(path).geometry.values())
    for mesh in meshes:
        mesh.merge_vertices(merge_norm=True)
    assert all(mesh.is_watertight for mesh in meshes)
    assert [mesh.volume for mesh in meshes] == pytest.approx(list(VOLUMES.values()), rel=1e-5)


@pytest.mark.parametrize("name", ["garage", "office_tower"])
def test_volumes_of_shipped_buildings_are_areas_times_heights(tmp_path: Path, name: str) -> None:
    plan = load_floor_plan(name)
    assert main(["plan", "export-mesh", {"garage": "garage_sar"}.get(name, name), "--out", str(tmp_path)]) == 0
    scene = trimesh.load_scene(next(tmp_path.glob("*.glb")))
    outlines = [(solid.element.height_m, shapely.Polygon(solid.corners)) for solid in solids(plan)]
    tops_m = [0.0, *sorted({height_m for height_m, _ in outlines})]
    expected = sum(  # layer by layer
        (high_m - low_m) * shapely.union_all([polygon for height_m, polygon in outlines if height_m >= high_m]).area
        for low_m, high_m in itertools.pairwise(tops_m)
    )
    holes = sum(shapely.Polygon(opening.polygon).area for opening in plan.openings)
    floors = [level.bounds for level in plan.levels] or [plan.bounds]
    floor_area = sum(shapely.box(*bounds.min, *bounds.max).area for bounds in floors) - holes
    found = dict.fromkeys((True, False), 0.0)
    for mesh_name, mesh in scene.geometry.items():
        found[mesh_name.startswith("floor")] += mesh.volume
    assert found == pytest.approx({True: 0.2 * floor_area, False: expected}, rel=1e-5)


def test_building_far_away_is_moved_and_one_line_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    far = "name: far\nbounds: {min: [500000.25, 7], max: [500010.25, 17]}\n"
    scene = trimesh.load_scene(_export(tmp_path, far, "glb"))
    assert list(scene.geometry) == ["floor"]
    assert scene.bounds == pytest.approx(np.array([[0.25, -0.2, -10.0], [10.25, 0.0, 0.0]]))
    assert "moved by [-500000, -7] m" in capsys.readouterr().err


def test_what_has_no_shape_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _export(tmp_path, TWO_FLOORS, "glb")
    assert capsys.readouterr().err == "robotteamsim: warning: passages: omitted: they have no shape\n"


def test_building_of_nothing_is_rejected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    level = "levels: [{name: L, bounds: {min: [0, 0], max: [9, 9]}, elevation_m: 0}]\n"
    hole = "openings: [{name: all, polygon: [[0, 0], [9, 0], [9, 9], [0, 9]]}]\n"
    (tmp_path / "p.yaml").write_text(f"name: p\nbounds: {{min: [0, 0], max: [9, 9]}}\n{level}{hole}")
    assert main(["plan", "export-mesh", f"{tmp_path}/p.yaml", "--out", str(tmp_path / "out")]) == 2
    assert "p: openings: leave no floor, and there is nothing else to export" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
