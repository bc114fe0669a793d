"""Scenarios as Stage worlds, and back."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import Scenario, load, occupancy_grid
from robotteamsim.scenario.body import corners_at
from robotteamsim.scenario.yaml_text import parse
from robotteamsim.stage import StageExport, StageImport, export_world, import_world
from robotteamsim.world.placement import placed_robots

SHIPPED = ("garage_sar", "tutorial_arena")


def _round_trip(scenario: Scenario, folder: Path) -> tuple[StageExport, StageImport]:
    export = export_world(scenario, "walls.png")
    (folder / "a.world").write_text(export.world, encoding="utf-8")
    (folder / "walls.png").write_bytes(export.bitmap)
    return export, import_world(folder / "a.world")


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_scenario_comes_back_as_it_was(name, tmp_path):
    scenario = load(name, ["robots.laser.noise_m=0.01", "robots.laser.angle_max_rad=1.0"])
    _, back = _round_trip(scenario, tmp_path)
    assert back.plan.bounds == scenario.plan.bounds
    before, after = placed_robots(scenario), placed_robots(back.scenario)
    assert len(after) == len(before)
    for one, other in zip(before, after, strict=True):
        assert _flat(other.model_dump(exclude={"odometry"})) == pytest.approx(
            _flat(one.model_dump(exclude={"odometry"})), abs=1e-8
        )
        assert (other.odometry.alpha1, other.odometry.alpha3) == pytest.approx((0.01, 0.001))
    assert (back.scenario.name, back.scenario.run) == (scenario.name, scenario.run)
    assert back.scenario.mission.time_limit_s == scenario.mission.time_limit_s


def _flat(values: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested values by dotted key, as approx wants them."""
    flat: dict[str, Any] = {}
    for key, value in values.items():
        parts = dict(enumerate(value)) if isinstance(value, tuple) else value
        flat |= _flat(parts, f"{prefix}{key}.") if isinstance(parts, dict) else {f"{prefix}{key}": parts}
    return flat


@pytest.mark.parametrize("name", SHIPPED)
def test_walls_come_back_within_a_cell(name, tmp_path):
    scenario = load(name)
    _, back = _round_trip(scenario, tmp_path)
    cells = [(occupancy_grid(plan, 0.05).cells > 0).astype(np.uint8) for plan in (scenario.plan, back.plan)]
    for one, other in (cells, cells[::-1]):
        assert np.all(cv2.dilate(other, np.ones((3, 3), np.uint8)) >= one)


def test_bitmap_is_cut_to_its_solid_cells_and_stands_where_they_were(tmp_path):
    """Stage stretches the dark pixels' own rectangle to the size, so there must be no margin."""
    plan = {
        "name": "yard",
        "bounds": {"min": [-3, -1], "max": [9, 7]},
        "blocks": [{"name": "a", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]]}],
        "doors": [
            {"name": "shut", "from": [4, 4], "to": [4, 5], "closed": True, "thickness_m": 0.1},
            {"name": "open", "from": [6, 4], "to": [6, 5]},
        ],
    }
    robots = {"count": 1, "start": [2, 2, 0]}
    scenario = Scenario.model_validate({"name": "yard", "plan": plan, "robots": robots})
    export, back = _round_trip(scenario, tmp_path)
    image = cv2.imread(str(tmp_path / "walls.png"), cv2.IMREAD_GRAYSCALE)
    # From x 0 to 4.05 and y 0 to 5; the highest y comes first.
    assert image.shape == (100, 81)
    assert np.all(image[-20:, :20] == 0)
    assert np.all(image[:20, -2:] == 0)
    assert np.count_nonzero(image == 0) == 20 * 20 + 20 * 2
    assert "size [ 4.05 5 2.6 ]\n  pose [ 2.025 2.5 0 0 ]" in export.world
    assert (back.plan.bounds.min, back.plan.bounds.max) == ((0.0, 0.0), (4.05, 5.0))
    assert any("Stage has no doors" in note for note in export.notes)


def test_numbers_are_written_without_exponents():
    world = export_world(
        load("garage_sar", ["robots.laser.noise_m=0.0001", "robots.laser.forward_m=1e-9"]), "w.png"
    ).world
    code = re.sub(r"#.*|\"[^\"]*\"", "", world)
    assert not re.search(r"\d[eE]", code)
    assert "noise [ 0.00000001 0 0 ]" in code


def test_robots_of_one_kind_share_its_definition():
    world = export_world(load("garage_sar"), "w.png").world
    assert world.count("define ") == 1
    assert world.count("robot_kind_0( pose") == 3


def test_robots_of_two_kinds_keep_their_order(tmp_path):
    text = "[{start_pose: [1, 1, 0]}, {start_pose: [3, 3, 1], radius_m: 0.3}, {start_pose: [5, 5, 2]}]"
    scenario = load("tutorial_arena", [f"robots={text}"])
    export, back = _round_trip(scenario, tmp_path)
    assert export.world.count("define ") == 2
    assert [robot.radius_m for robot in placed_robots(back.scenario)] == pytest.approx([0.2, 0.3, 0.2])
    headings = [robot.start_pose[2] for robot in placed_robots(back.scenario)]
    assert headings == pytest.approx([0.0, 1.0, 2.0])


def test_rays_pass_below_the_lowest_robot_and_tf_keeps_the_lasers_height():
    """The ranger stands at 0.25 m, as high as the robots are; its sensor half as high, so that it sees them."""
    world = export_world(load("tutorial_arena"), "w.png").world
    ranger = world[world.index("ranger") :]
    poses = re.findall(r"pose \[ (\S+) (\S+) (\S+) (\S+) \]", ranger)
    assert [float(poses[0][2]), float(poses[1][2])] == [0.0, -0.125]


def test_exact_odometry_is_gps():
    exact = [f"robots.odometry.alpha{i}=0" for i in (1, 2, 3, 4)]
    export = export_world(load("tutorial_arena", exact), "w.png")
    assert 'localization "gps"' in export.world
    assert "odom_error" not in export.world
    assert export.notes == ("robots: stage_ros omits robot_0/ in the names of topics if there is only one robot",)


def test_plan_without_solids_is_refused():
    plan = parse("{name: field, bounds: {max: [5, 5]}}", "plan")
    scenario = Scenario.model_validate({"name": "field", "plan": plan, "robots": {"count": 1, "start": [2, 2, 0]}})
    with pytest.raises(ScenarioError, match="has no wall, block or closed door for a bitmap"):
        export_world(scenario, "w.png")


def test_too_fine_a_bitmap_is_refused():
    with pytest.raises(ScenarioError, match=r"^garage_sar: plan: has 2400000000 pixels of 0\.001 m; expected at most"):
        export_world(load("garage_sar"), "w.png", 0.001)


def test_omnidirectional_robots_come_back_as_they_were(tmp_path):
    drive = {"kind": "omni", "max_speed_mps": 0.5}
    scenario = load("garage_sar", [f"robots.drive={drive}"])
    _, imported = _round_trip(scenario, tmp_path)
    assert placed_robots(imported.scenario)[0].drive == placed_robots(scenario)[0].drive


def test_car_is_refused():
    scenario = load("garage_sar", ["robots.drive={kind: car, wheelbase_m: 0.3, max_steering_rad: 0.6}"])
    with pytest.raises(
        ScenarioError, match=r"^garage_sar: robots\.drive\.kind: in Stage, the turn of a car is a steering angle"
    ):
        export_world(scenario, "garage.png")


EQUIPPED = [
    "robots.spacing_m=1.5",
    "robots.footprint_m=[[-0.1, -0.2], [0.5, -0.2], [0.6, 0.0], [0.5, 0.2], [-0.1, 0.2]]",
    "robots.lasers=[{name: rear, forward_m: -0.1, left_m: 0.05, yaw_rad: 3.0, beams: 91, every_steps: 3},"
    " {name: low, height_m: 0.1, angle_min_rad: -0.5, angle_max_rad: 0.5, range_max_m: 8.0, noise_m: 0.02}]",
    "robots.sonars=[{name: sonar_left, left_m: 0.2, yaw_rad: 1.5, rays: 9, opening_rad: 0.4},"
    " {name: sonar_right, left_m: -0.2, yaw_rad: -1.5, range_max_m: 2.0, noise_m: 0.01}]",
]


def test_bodies_lasers_and_sonars_come_back_as_they_were(tmp_path):
    scenario = load("tutorial_arena", EQUIPPED)
    _, back = _round_trip(scenario, tmp_path)
    (before,), (after,) = placed_robots(scenario), placed_robots(back.scenario)
    one, other = (robot.model_dump(exclude={"odometry", "footprint_m", "radius_m"}) for robot in (before, after))
    assert _flat(other) == pytest.approx(_flat(one), abs=1e-8)
    np.testing.assert_allclose(sorted(after.corners_m), sorted(before.corners_m), atol=1e-8)


def test_laser_whose_beams_lie_to_one_side_keeps_where_they_point(tmp_path):
    laser = "{name: side, yaw_rad: 0.3, angle_min_rad: 0.2, angle_max_rad: 1.4, beams: 7}"
    _, back = _round_trip(load("tutorial_arena", [f"robots.lasers=[{laser}]"]), tmp_path)
    (after,) = placed_robots(back.scenario)[0].lasers
    ends = (after.yaw_rad + after.angle_min_rad, after.yaw_rad + after.angle_max_rad)
    assert ends == pytest.approx((0.5, 1.7))


def test_objects_come_back_as_solids_at_their_places(tmp_path):
    objects = (
        "[{name: crate, size_m: [0.6, 0.4], pose: [2.0, 2.0, 0.5]},"
        " {name: drum, kind: barrel, radius_m: 0.3, height_m: 0.9, pose: [4.0, 4.0, 0.0]}]"
    )
    scenario = load("tutorial_arena", [f"objects={objects}"])
    export, back = _round_trip(scenario, tmp_path)
    solid = {
        block.name: shapely.Polygon(block.polygon) for block in back.plan.blocks if block.name in ("crate", "drum")
    }
    crate = shapely.Polygon(corners_at(scenario.objects[0].corners_m, scenario.objects[0].pose))
    assert shapely.symmetric_difference(solid["crate"], crate).area < 1e-5
    assert (solid["drum"].centroid.x, solid["drum"].centroid.y) == pytest.approx((4.0, 4.0))
    assert solid["drum"].area == pytest.approx(math.pi * 0.3**2, rel=0.03)
    assert "objects: cannot be pushed in Stage" in export.notes


def test_what_stage_cannot_tell_is_said_in_one_line_each():
    gps = "robots.gps={datum_lat_deg: 40.0, datum_lon_deg: -8.0}"
    notes = export_world(load("garage_sar", [*EQUIPPED, gps]), "w.png").notes
    assert [note.partition(": ")[0] for note in notes] == [
        "odometry",
        "doors",
        "sonars",
        "lasers, sonars",
        "gps",
    ]
    assert all("\n" not in note for note in notes)
