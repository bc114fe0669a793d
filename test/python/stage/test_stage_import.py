"""Stage worlds as scenarios."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.formats import Imported
from robotteamsim.scenario import load_floor_plan, occupancy_grid, solids
from robotteamsim.setup import resolve
from robotteamsim.stage import import_world

DATA = Path(__file__).parents[2] / "data" / "stage"

ROOM = "model( size [ 10 8 1 ] pose [ 5 4 0 0 ] noblocks 1 boundary 1 )\n"
ROBOT = "position( pose [ 2 2 0 0 ] size [ 0.4 0.4 0.25 ] ranger( sensor( range [ 0 5 ] fov 180 samples 181 ) ) )\n"


@pytest.fixture
def world_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return what a world given as a text is imported as."""
    monkeypatch.chdir(tmp_path)

    def imported(text: str) -> Imported:
        Path("a.world").write_text(text, encoding="utf-8")
        return import_world("a.world")

    return imported


def _robot(text: str) -> str:
    """Return a robot with more said of it."""
    return ROBOT.replace("position(", f"position( {text} ")


def test_world_in_one_file_becomes_a_scenario():
    found = import_world(DATA / "hall.world")
    assert (found.plan.bounds.min, found.plan.bounds.max) == ((-8.0, 0.0), (0.0, 12.0))
    robot = resolve(found.scenario).robots[0]
    assert robot.start_pose == (-3.0, 4.5, math.pi)
    assert (robot.laser.beams, robot.laser.range_max_m, robot.laser.forward_m) == (1081, 20.0, 0.1)
    assert robot.laser.angle_max_rad == -robot.laser.angle_min_rad == pytest.approx(math.radians(270.25 / 2))
    assert robot.laser.height_m == pytest.approx(0.2)
    assert (robot.drive.max_speed_mps, robot.drive.max_turn_radps) == (1.0, pytest.approx(math.pi / 2))
    assert found.scenario.run.step_s == 0.05
    assert [block.name for block in found.plan.blocks] == ["crate"]


def test_turned_bitmap_is_solid_where_its_picture_is():
    """The grid of the plan, turned back by hand, is the picture without its margin."""
    found = import_world(DATA / "hall.world")
    walls_only = found.plan.model_copy(update={"blocks": ()})
    cells = occupancy_grid(walls_only, 0.05).cells > 0
    picture = cv2.imread(str(DATA / "hall.png"), cv2.IMREAD_GRAYSCALE)[10:170, 5:245] < 128
    assert np.array_equal(np.rot90(np.flipud(cells), -1), picture)


def test_world_of_included_parts_becomes_a_scenario():
    found = import_world(DATA / "patrol" / "patrol.world")
    assert (found.plan.bounds.min, found.plan.bounds.max) == ((0.0, 0.0), (12.0, 8.0))
    one, other = resolve(found.scenario).robots
    assert one.start_pose == (2.0, 2.0, pytest.approx(math.pi / 2))
    assert other.start_pose == (10.0, 6.0, pytest.approx(-math.pi / 2))
    assert one.radius_m == pytest.approx(0.18, abs=2e-4)
    assert (one.drive.max_speed_mps, one.drive.max_turn_radps) == (0.5, pytest.approx(math.pi / 3))
    assert (one.drive.max_acceleration_mps2, one.drive.max_turn_acceleration_radps2) == (
        1.0,
        pytest.approx(math.pi / 2),
    )
    assert (one.laser.noise_m, one.laser.height_m) == (pytest.approx(0.02), pytest.approx(0.15))
    assert (one.odometry.alpha1, one.odometry.alpha3) == (pytest.approx(math.radians(1.0) ** 2, abs=1e-9), 0.0004)
    assert (found.scenario.name, found.scenario.mission.time_limit_s) == ("patrol", 3600.0)


def test_ignored_properties_are_reported_in_one_line_per_file():
    notes = import_world(DATA / "patrol" / "patrol.world").notes
    told = {line.partition(": ")[0]: line.partition(": ")[2] for line in notes if "no effect" in line}
    folder = str(DATA / "patrol")
    assert told == {
        f"{folder}/patrol.world": "no effect here: speedup (line 7)",
        f"{folder}/floor.inc": "no effect here: color (line 3), gui_move (line 4), fiducial_return (line 5)",
        f"{folder}/team.inc": "no effect here: color (line 1, 2)",
    }


def test_equal_robots_are_a_team_and_others_a_list(world_of):
    second = ROBOT.replace("2 2 0 0", "4 4 0 0")
    assert world_of(ROOM + ROBOT + second).keys["robots"]["count"] == 2
    robots = world_of(ROOM + ROBOT + second.replace("181", "91")).keys["robots"]
    assert [robot["laser"]["beams"] for robot in robots] == [181, 91]


def test_wide_robots_are_a_team_too(world_of):
    robots = [ROBOT.replace("0.4 0.4", "1.6 1.6").replace("2 2 0 0", f"{x} 4 0 0") for x in (2, 6)]
    assert world_of(ROOM + "".join(robots)).scenario.robots.count == 2


def test_boundary_is_a_thin_wall_along_the_size(world_of):
    plan = world_of(ROOM + ROBOT).plan
    assert [wall.thickness_m for wall in plan.walls] == [0.01] * 4
    assert occupancy_grid(plan, 0.01).cells[1:-1, 1:-1].max() == 0
    assert occupancy_grid(plan, 0.01).cells[[0, -1]].min() == 100


def test_blocks_are_stretched_to_the_size_and_moved_by_origin_and_pose(world_of):
    block = "block( points 3 point[0] [ 0 0 ] point[1] [ 2 0 ] point[2] [ 0 1 ] z [ 0 1 ] )"
    model = f'model( name "ramp" size [ 1 2 0.5 ] origin [ 0.5 0 0 0 ] pose [ 6 4 0 90 ] {block} )'
    assert world_of(ROOM + ROBOT + model).plan.blocks[0].polygon == ((7.0, 4.0), (7.0, 5.0), (5.0, 4.0))


def test_model_without_blocks_is_a_box_of_its_size(world_of):
    plan = world_of(ROOM + ROBOT + "model( size [ 1 2 0.5 ] pose [ 5 5 0 0 ] )model( pose [ 8 5 0 0 ] )").plan
    assert [solid.polygon.bounds for solid in solids(plan)[4:]] == [(4.5, 4.0, 5.5, 6.0), (7.8, 4.8, 8.2, 5.2)]


def test_kind_may_be_defined_by_the_name_of_a_part(world_of):
    """As in the world that comes with stage_ros, where `block` is a model."""
    text = "define block model( size [ 0.5 0.5 0.5 ] )\n" + ROOM + ROBOT + "block( pose [ 5 5 0 180 ] )"
    assert [solid.polygon.bounds for solid in solids(world_of(text).plan)[4:]] == [(4.75, 4.75, 5.25, 5.25)]


def test_model_on_a_model_is_placed_in_its_frame(world_of):
    text = "model( size [ 2 2 0.1 ] pose [ 6 4 0 90 ] stack_children 0 model( size [1 0.2 0.2] pose [ 1 0 0 0 ] ) )"
    plan = world_of(ROOM + ROBOT + text).plan
    assert solids(plan)[-1].polygon.bounds == pytest.approx((5.9, 4.5, 6.1, 5.5))


def test_units_of_the_world_are_taken(world_of):
    text = (ROOM + ROBOT).replace("10 8 1", "1000 800 100").replace("5 4 0 0", "500 400 0 0")
    text = text.replace("2 2 0 0", "200 300 0 1.5").replace("0.4 0.4 0.25", "40 40 25").replace("[ 0 5 ]", "[ 0 500 ]")
    robot = resolve(world_of('unit_length "cm"\nunit_angle "radians"\n' + text.replace("180", "3.14")).scenario).robots[
        0
    ]
    assert robot.start_pose == (2.0, 3.0, 1.5)
    assert (robot.laser.range_max_m, robot.laser.angle_max_rad) == (5.0, 1.57)


def test_old_laser_model_is_a_ranger(world_of):
    text = "position( pose [2 2 0 0] laser( range_max 8 fov 90 samples 46 pose [0.1 0 0 90] ) )"
    laser = resolve(world_of(ROOM + text).scenario).robots[0].laser
    assert (laser.beams, laser.range_max_m, laser.forward_m) == (46, 8.0, 0.1)
    assert (laser.angle_min_rad, laser.angle_max_rad) == pytest.approx((math.pi / 4, 3 * math.pi / 4))


def test_gps_is_exact_odometry(world_of):
    odometry = resolve(world_of(ROOM + _robot('localization "gps"')).scenario).robots[0].odometry
    assert (odometry.alpha1, odometry.alpha2, odometry.alpha3, odometry.alpha4) == (0.0, 0.0, 0.0, 0.0)


def test_box_is_a_body_with_corners(world_of):
    found = world_of(ROOM + ROBOT.replace("size [ 0.4 0.4", "origin [ 0.1 0 0 0 ] size [ 0.4 0.2"))
    corners_m = resolve(found.scenario).robots[0].corners_m
    expected = [(-0.1, -0.1), (-0.1, 0.1), (0.3, -0.1), (0.3, 0.1)]
    np.testing.assert_allclose(sorted(corners_m), expected, atol=1e-9)
    assert found.notes == ()


def test_body_that_is_not_convex_becomes_its_convex_hull(world_of):
    corners = ["[ 0 0 ]", "[ 2 0 ]", "[ 2 2 ]", "[ 1 0.5 ]", "[ 0 2 ]"]
    points = " ".join(f"point[{i}] {corner}" for i, corner in enumerate(corners))
    found = world_of(ROOM + _robot(f"block( points 5 {points} )"))
    corners_m = resolve(found.scenario).robots[0].corners_m
    assert sorted(corners_m) == [(-0.2, -0.2), (-0.2, 0.2), (0.2, -0.2), (0.2, 0.2)]
    assert found.notes == (
        "a.world:2: size: the body of 'position' is not convex with 3 to 8 corners around its origin: it becomes its "
        "convex hull",
    )


def test_body_with_many_corners_becomes_the_smaller_of_a_box_and_a_disc(world_of):
    """Of an ellipse with 12 corners the box around it, 1.2 x 0.4 m, not the disc of radius 0.6 m."""
    corners = [(math.cos(math.pi * i / 6), math.sin(math.pi * i / 6)) for i in range(12)]
    points = " ".join(f"point[{i}] [ {x:.6f} {y:.6f} ]" for i, (x, y) in enumerate(corners))
    text = _robot(f"block( points 12 {points} )").replace("0.4 0.4", "1.2 0.4")
    corners_m = resolve(world_of(ROOM + text).scenario).robots[0].corners_m
    np.testing.assert_allclose(sorted(corners_m), [(-0.6, -0.2), (-0.6, 0.2), (0.6, -0.2), (0.6, 0.2)], atol=1e-6)


def test_additional_rangers_are_lasers_and_those_called_sonar_are_sonars(world_of):
    more = (
        'ranger( name "Sonar 1" pose [ 0 0.2 0 90 ] sensor( range [ 0.1 3 ] fov 30 samples 7 ) )'
        " ranger( pose [ -0.2 0 0 180 ] update_interval 300 sensor( range [ 0 4 ] fov 90 samples 91 ) )"
        ' ranger( name "fix" sensor( range [ 0 4 ] fov 90 samples 91 ) )'
    )
    robot = resolve(world_of(ROOM + _robot(more)).scenario).robots[0]
    *lasers, sonar = robot.sensors
    assert [(laser.kind, laser.name, laser.beams, laser.every_steps) for laser in lasers] == [
        ("laser", "fix", 91, 1),
        ("laser", "ranger_2", 181, 1),
    ]
    assert (robot.laser.beams, robot.laser.forward_m) == (91, -0.2)
    assert (sonar.kind, sonar.name, sonar.rays, sonar.left_m, sonar.range_min_m) == ("sonar", "sonar_1", 7, 0.2, 0.1)
    assert (sonar.opening_rad, sonar.yaw_rad) == pytest.approx((math.radians(30.0), math.pi / 2))


def test_sonar_of_one_ray_becomes_a_cone(world_of):
    sonar = 'ranger( name "sonar" sensor( range [ 0 3 ] fov 20 samples 1 ) )'
    found = world_of(ROOM + _robot(sonar))
    assert resolve(found.scenario).robots[0].sensors[0].rays == 15
    assert found.notes == ("a.world:2: samples: one ray in Stage, a cone of rays here",)


def test_model_that_hangs_above_the_robots_is_left_out(world_of):
    found = world_of(ROOM + ROBOT + "model( size [ 1 1 1 ] pose [ 5 5 2 0 ] )")
    assert found.plan.blocks == ()
    assert "a.world:3: 'model_2' omitted: it is at 2 m, above all robots" in found.notes


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (_robot('ctrl "wander"'), "ctrl: omitted: Stage's controllers cannot run here; control.algorithm drives"),
        (
            _robot("sampels 3"),
            "sampels: unknown key of a 'position', in Stage and here; did you mean 'samples'?",
        ),
        (_robot('drive "omni" velocity_bounds [-1 1 -2 2 0 0 -90 90]'), "velocity_bounds: the limits of x and y"),
        (_robot("camera()"), "camera: omitted: robots have no camera here"),
        (_robot("localization_origin [0 0 0 0]"), "localization_origin: omitted: odometry starts at 0 here"),
        (_robot("velocity_bounds [-0.2 1 0 0 0 0 -90 90]"), "velocity_bounds: the lower and upper limits of x differ"),
        (ROBOT.replace("2 2 0 0", "2 2 0.5 0"), "pose: z 0.5 counts as 0; robots drive on the floor"),
        ("position( pose [2 2 0 0] )", "'position' has no ranger; it gets the default laser"),
        (ROBOT.replace(" ) ) )", " ) sensor() ) )"), "ranger: each sensor has a topic here; stage_ros publishes only"),
        (ROBOT.replace("fov", "noise [0 0.1 0] fov"), "noise: only the constant part is simulated"),
        (ROBOT + "fiducial()\n", "fiducial: omitted: a 'fiducial' that is not on a robot"),
    ],
)
def test_changed_property_is_reported_at_its_line(world_of, text, note):
    notes = world_of(ROOM + text).notes
    assert any(
        line.startswith(f"a.world:{2 + text.count(chr(10), 0, text.find('fid'))}: {note}") for line in notes
    ) or any(line.startswith(f"a.world:2: {note}") for line in notes)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (ROOM + _robot("ragner()"), "a.world:2: ragner: unknown model 'ragner'; did you mean 'ranger'?"),
        (ROOM + ROBOT.replace("2 2 0 0", "2 2 0"), "a.world:2: pose: [2 2 0] is not 4 numbers, [x y z heading]"),
        (
            ROOM + ROBOT.replace("2 2 0 0", '2 2 0 "a"'),
            "a.world:2: pose: [2 2 0 'a'] is not 4 numbers, [x y z heading]",
        ),
        (
            ROOM + ROBOT.replace("2 2 0 0", "0.1 2 0 0"),
            "a.world:2: pose: [0.1, 2]: robot 0 overlaps wall",
        ),
        (ROOM + ROBOT + ROBOT, "a.world:3: pose: [2, 2]: robot 1 overlaps robot 0"),
        ("ranger()", "a.world: nothing to import: no robot, and no model with a bitmap, blocks or boundary 1"),
        (ROOM + "puck()" + ROBOT, "a.world:2: puck: unknown model 'puck'"),
        ("block( points 3 )" + ROBOT, "a.world:1: block: a 'block' that is not in a model"),
        (ROOM + _robot("sensor()"), "a.world:2: sensor: a 'sensor' that is not in a ranger"),
        ('interval_sim "a"\n' + ROOM + ROBOT, "a.world:1: interval_sim: 'a' is not a number"),
        (ROBOT + "model( bitmap 3 )", "a.world:2: bitmap: there is no file '3'"),
        (ROBOT + 'model( bitmap "no.png" )', "a.world:2: bitmap: there is no file 'no.png'"),
        (ROBOT + 'model( bitmap "a.world" )', "a.world:2: bitmap: 'a.world' cannot be read as an image"),
        (
            ROBOT + "model( size [ 2000 1 1 ] pose [ 0 5 0 0 ] )",
            "a.world:2: model: bounds.max: x 1000 is more than 1000 m from min",
        ),
    ],
)
def test_bad_world_is_rejected_in_one_line(world_of, text, message):
    with pytest.raises(ScenarioError) as refused:
        world_of(text)
    assert str(refused.value).startswith(message)
    assert "\n" not in str(refused.value)


def test_robot_in_a_wall_is_a_mistake_of_place(world_of):
    with pytest.raises(PlacementError):
        world_of(ROOM + ROBOT.replace("2 2 0 0", "0 2 0 0"))


def test_coloured_line_is_a_wall_and_a_single_pixel_is_not(world_of, tmp_path):
    picture = np.full((20, 20, 3), 255, np.uint8)
    picture[[0, -1]] = picture[:, [0, -1]] = (255, 255, 0)  # blue, green, red: cyan has no red
    picture[10, 10] = (0, 0, 255)  # red
    cv2.imwrite(str(tmp_path / "room.png"), picture)
    plan = world_of(ROBOT + 'model( bitmap "room.png" size [ 10 10 1 ] pose [ 5 5 0 0 ] )').plan
    assert np.count_nonzero(occupancy_grid(plan, 0.5).cells) == 4 * 19


def test_bitmap_and_map_server_image_of_one_building_have_the_same_walls(world_of, tmp_path):
    picture = np.full((100, 200), 254, np.uint8)
    picture[[0, -1]] = picture[:, [0, -1]] = 0
    picture[20:40, 50] = 0
    picture[20:40, [49, 51]] = 150  # a smoothed edge
    picture[60:90, 100:130] = 205
    picture[60, 100:130] = 0
    cv2.imwrite(str(tmp_path / "room.png"), picture)
    keys = "image: room.png\nresolution: 0.1\norigin: [0, 0, 0]\n"
    (tmp_path / "room.yaml").write_text(keys, encoding="utf-8")
    found = world_of(ROBOT + 'model( bitmap "room.png" size [ 20 10 1 ] pose [ 10 5 0 0 ] )')
    cells = [occupancy_grid(plan, 0.1).cells for plan in (found.plan, load_floor_plan(tmp_path / "room.yaml"))]
    np.testing.assert_array_equal(*cells)
    assert any("are read differently from Stage" in note for note in found.notes)
