"""What Stage 4.3 loads is imported; each right value is from its source (version 4.3.0) or calculated by hand."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.formats import Imported
from robotteamsim.scenario import FloorPlan, solids
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation
from robotteamsim.stage import import_world

ROOM = "model( size [ 10 8 1 ] pose [ 5 4 0 0 ] noblocks 1 boundary 1 )\n"
LASER = "ranger( sensor( range [ 0 5 ] fov 180 samples 181 ) )"
ROBOT = f"position( pose [ 2 2 0 0 ] size [ 0.4 0.4 0.25 ] {LASER} )\n"
BLOCK = "block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] z [0 1] )"


@pytest.fixture
def world_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return what a world given as a text is imported as."""
    monkeypatch.chdir(tmp_path)

    def imported(text: str, *, grey_as_stage: bool = False) -> Imported:
        Path("a.world").write_text(text, encoding="utf-8")
        return import_world("a.world", grey_as_stage=grey_as_stage)

    return imported


def _robot(found: Imported, index: int = 0) -> PlacedRobot:
    assert found.scenario is not None
    return resolve(found.scenario).robots[index]


def _solid_m2(plan: FloorPlan) -> float:
    return float(shapely.union_all([solid.polygon for solid in solids(plan)]).area)


def _with(text: str) -> str:
    """Return a robot with more said of it."""
    return ROBOT.replace("position(", f"position( {text} ")


@pytest.mark.parametrize(
    ("keys", "note"),
    [
        (
            "obstacle_return 0 ranger_return 0.5",
            "obstacle_return: robots cannot drive through 'model' here",
        ),
        (
            "obstacle_return 0 ranger_return 0",
            "obstacle_return: robots cannot drive through 'model' here",
        ),
        ("ranger_return -1", "ranger_return: lasers see 'model' here; in Stage it only stops robots"),
    ],
)
def test_body_that_only_lasers_or_only_robots_meet_is_solid_with_a_warning(world_of, keys, note):
    found = world_of(ROOM + ROBOT + f"model( size [ 0.3 0.3 0.2 ] pose [ 5 4 0 0 ] {keys} )")
    assert [block.name for block in found.plan.blocks] == ["model_2"]
    assert any(line.startswith(f"a.world:3: {note}") for line in found.notes)


def test_body_that_is_no_obstacle_is_omitted_where_a_robot_starts_in_it(world_of):
    found = world_of(ROOM + ROBOT + 'model( name "mat" size [ 1 1 0.1 ] pose [ 2 2 0 0 ] obstacle_return 0 )')
    assert found.plan.blocks == ()
    assert "a.world:3: 'mat' omitted: it is no obstacle, and a robot starts in it" in found.notes


def test_body_in_which_a_robot_starts_is_hollow(world_of):
    """Stage renders outlines only (world.cc: MapPoly), so a box without noblocks is a room."""
    found = world_of(ROOM.replace("noblocks 1 ", "") + ROBOT)
    assert (found.plan.bounds.min, found.plan.bounds.max) == ((-0.005, -0.005), (10.005, 8.005))
    assert [wall.thickness_m for wall in found.plan.walls] == [0.01] * 4
    assert found.plan.blocks == ()


def test_numbers_beyond_those_that_stage_reads_are_ignored(world_of):
    found = world_of(ROOM + _with('localization "odom" odom_error [0.03 0.03 0 0.5 0 0.02]'))
    odometry = _robot(found).odometry
    assert (odometry.alpha1, odometry.alpha3) == (pytest.approx(math.radians(0.5) ** 2, abs=1e-9), 0.0009)
    assert "a.world:2: odom_error: only the first 4 of 6 values count, as in Stage" in found.notes


def test_numbers_are_read_as_by_atof(world_of):
    found = world_of(ROOM + _with('mass "3" size ["0.6" 0.6.1 0.25]').replace("size [ 0.4 0.4 0.25 ]", ""))
    assert (_robot(found).mass_kg, max(_robot(found).corners_m)) == (3.0, (0.3, 0.3))
    assert "a.world:2: size: '0.6.1' counts as 0.6, as in Stage" in found.notes


def test_parts_on_a_robot_belong_to_its_body_and_rangers_on_them_are_its_sensors(world_of):
    """A tail of 0.2 m that begins 0.2 m behind the middle, which ends 0.3 m behind it, and a gripper in front."""
    tail = (
        f"model( pose [ -0.2 0 0 180 ] size [ 0.2 0.4 0.05 ] {LASER.replace('ranger(', 'ranger( pose [0.1 0 0 0]')} )"
    )
    text = (
        f"position( pose [ 2 2 0 0 ] size [ 0.4 0.4 0.2 ] {tail} gripper( pose [ 0.3 0 0 0 ] size [ 0.2 0.4 0.1 ] ) )"
    )
    robot = _robot(world_of(ROOM + text))
    np.testing.assert_allclose(sorted(robot.corners_m), [(-0.3, -0.2), (-0.3, 0.2), (0.4, -0.2), (0.4, 0.2)], atol=1e-9)
    assert (robot.laser.forward_m, robot.laser.height_m) == (-0.3, 0.25)
    assert robot.laser.angle_min_rad == pytest.approx(math.pi / 2)


def test_part_on_a_robot_that_is_no_obstacle_is_not_of_its_body(world_of):
    text = _with("model( pose [ 0 0 0 0 ] size [ 1 1 0.1 ] obstacle_return 0 )")
    assert max(_robot(world_of(ROOM + text)).corners_m) == (0.2, 0.2)


def test_rangers_of_several_single_rays_are_sonars_beside_the_default_laser(world_of):
    """As p2dx_sonar of Stage's pioneer.inc."""
    ring = "".join(f"sensor( pose [ 0.1 {pose} ] range [ 0 5 ] fov 15 samples 1 )" for pose in ("0.1 0 90", "0 0 10"))
    for name in ("", 'name "sonar"'):
        found = world_of(ROOM + f"position( pose [ 2 2 0 0 ] ranger( {name} {ring} ) )")
        robot = _robot(found)
        assert (robot.laser.beams, robot.laser.range_max_m) == (181, 5.0)
        assert [(sensor.kind, sensor.left_m) for sensor in robot.sensors] == [("sonar", 0.1), ("sonar", 0.0)]
        assert [sensor.yaw_rad for sensor in robot.sensors] == pytest.approx([math.pi / 2, math.radians(10.0)])
        assert any("has no ranger but sonars; it gets the default laser" in note for note in found.notes)


def test_laser_beside_the_axis_has_its_offset_and_sees_from_there(world_of):
    """0.3 m to the left of a robot at [2, 2] that looks along x: the beam to the left meets the wall at y = 7.99 m."""
    text = ROBOT.replace("ranger(", "ranger( pose [ 0.1 0.3 0 0 ]").replace("[ 0 5 ]", "[ 0 9 ]")
    found = world_of(ROOM + text)
    laser = _robot(found).laser
    assert (laser.forward_m, laser.left_m, found.notes) == (0.1, 0.3, ())
    ranges_m = Simulation(resolve(found.scenario)).sense().state.ranges_m[0]
    assert (ranges_m[0], ranges_m[-1]) == pytest.approx((2.3 - 0.01, 8.0 - 2.3 - 0.01), abs=1e-4)


def test_only_sample_of_a_sensor_is_straight_ahead(world_of):
    """model_ranger.cc: start_angle is 0 unless sample_count > 1. 8 m to the front, a box beside it 2 m away."""
    ray = "ranger( sensor( range [ 0 9 ] samples 1 fov 30 ) )"
    box = "model( size [ 0.2 0.6 1 ] pose [ 4 1.3 0 0 ] )"
    found = world_of(ROOM + f"position( pose [ 2 2 0 0 ] size [ 0.4 0.4 0.2 ] {ray} )" + box)
    assert Simulation(resolve(found.scenario)).sense().state.ranges_m[0].tolist() == pytest.approx([7.99], abs=1e-4)


@pytest.mark.parametrize(
    ("keys", "note"),
    [
        (
            "velocity_bounds [-100 100 -100 100 -1 1 -90 90]",
            "velocity_bounds: max_speed_mps: 100.0 is above 10: 10 is used",
        ),
        ('drive "dif"', "drive: 'dif' is not one of diff, omni, car: 'diff', as in Stage; did you mean 'diff'?"),
        ("obstacle_return 0", "obstacle_return: others hit and detect this robot here"),
        ('bitmap "x.png"', "bitmap: x.png: becomes a box of its size"),
        ("mass -1", "mass: -1 counts as not given"),
        ("ranger()", "ranger: omitted: a ranger without a sensor measures nothing"),
        ("camera( resolution [ 80 60 ] pantilt [ 0 0 ] )", "camera: omitted: robots have no camera here"),
        (
            "ranger( sensor( samples 100000 fov 90 ) )",
            "samples: beams: 100000 is above 10000: 10000 is used",
        ),
        ("ranger( sensor( samples 2.5 fov 90 ) )", "samples: 2.5 counts as 2, as in Stage"),
        ("ranger( sensor( samples 0 ) )", "samples: beams: 0 is below 1: 1 is used"),
        ("ranger( sensor( range [ 5 5 ] ) )", "range: the minimum, 5, is not below the maximum and counts as 0"),
        ("position()", "position: part of its robot's body, without a function: a 'position'"),
    ],
)
def test_what_can_be_approximated_is_imported_with_one_warning(world_of, keys, note):
    notes = [line for line in world_of(ROOM + _with(keys)).notes if "convex" not in line and "every" not in line]
    assert notes == [f"a.world:2: {note}"]


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (ROOM + ROBOT.replace("0.4 0.4", "9 9"), "a.world:2: size: radius_m: 6.363961031 is above 5: 5 is used"),
        (
            ROOM + ROBOT.replace("0.4 0.4", "0 0.4"),
            "a.world:2: size: negative sizes count as positive, a width of 0 as",
        ),
        ("interval_sim 0\n" + ROOM + ROBOT, "a.world:1: interval_sim: step_s: 0.0 is below 0.001: 0.001 is used"),
        ('unit_length "km"\n' + ROOM + ROBOT, "a.world:1: unit_length: 'km' is not one of m, cm, mm: 'm', as in Stage"),
        (
            ROOM + ROBOT + "model( size [ 1 1 1 ] pose [ 6 6 0 0 ] block( points 3 ) )",
            "a.world:3: points: point[0] is missing",
        ),
        (ROOM + ROBOT + "model( block( points 0 ) )", "a.world:3: points: no points: omitted"),
    ],
)
def test_odd_world_is_imported_with_a_warning(world_of, text, note):
    if "9 9" in text:
        text = text.replace("10 8 1", "40 40 1")
    notes = world_of(text).notes
    assert any(line.startswith(note) for line in notes)


def test_car_is_a_car_whose_yaw_rate_at_full_steering_is_the_limit(world_of):
    found = world_of(ROOM + _with('drive "car" wheelbase 0.3 velocity_bounds [-2 2 0 0 0 0 -90 90]'))
    drive = _robot(found).drive
    assert (drive.kind, drive.wheelbase_m, drive.max_speed_mps) == ("car", 0.3, 2.0)
    assert drive.max_turn_radps == pytest.approx(math.pi / 2)
    assert "a.world:2: drive: the turn of a command is a yaw rate here, a steering angle in Stage" in found.notes


def test_bounds_hold_robots_outside_the_walls(world_of):
    found = world_of("model( size [ 0.5 0.5 0.5 ] pose [ 3 0 0 0 ] )\n" + ROBOT.replace("2 2 0 0", "0 0 0 0"))
    bounds = found.plan.bounds
    assert bounds.contains((-5.0, -5.0))
    assert bounds.contains((3.25, 5.0))
    assert world_of(ROBOT).plan.bounds.contains((7.0, 7.0))


def test_world_without_robots_is_a_plan(world_of):
    found = world_of(ROOM)
    assert (len(found.plan.walls), found.scenario, found.keys) == (4, None, {})


def test_robot_on_a_model_is_placed_in_its_frame(world_of):
    found = world_of(ROOM + "model( pose [ 5 4 0 90 ] obstacle_return 0 ranger_return -1 " + ROBOT.strip() + " )")
    assert _robot(found).start_pose == (3.0, 6.0, pytest.approx(math.pi / 2))


def test_boundary_counts_only_without_blocks(world_of):
    """Model::Load adds it to the default block, which LoadBlock clears: 2 m2 of blocks, no fence."""
    left, right = BLOCK, BLOCK.replace("[0 0]", "[3 0]").replace("[0 1] z", "[3 1] z").replace("[1 ", "[4 ")
    fence = f"model( size [ 4 3 1 ] pose [ 5 5 0 0 ] boundary 1 {left} {right} )"
    found = world_of(ROOM + ROBOT + fence)
    assert [len(found.plan.walls), len(found.plan.blocks)] == [4, 2]
    assert _solid_m2(found.plan) == pytest.approx(2 * 1.0 * 3.0 + 2 * 0.01 * (10.0 + 7.98))


def test_scans_come_every_100_ms_unless_the_file_says_otherwise(world_of):
    rangers = f"{LASER} {LASER} {LASER.replace('ranger(', 'ranger( update_interval 40')}"
    found = world_of(f"interval_sim 20\n{ROOM}position( pose [ 2 2 0 0 ] {rangers} )")
    assert [sensor.every_steps for sensor in _robot(found).sensors] == [5, 2]
    assert (
        "a.world:3: update_interval: the first laser scans in every step of 20 ms; in Stage every 100 ms" in found.notes
    )


def test_odometry_error_without_a_value_is_drawn_once_for_each_robot(world_of):
    """model_position.cc: uniformly within half of 0.03 and 0.05."""
    second = _with('localization "odom"').replace("2 2 0 0", "5 5 0 0")
    found = world_of(ROOM + _with('localization "odom"') + second)
    odometries = [_robot(found, i).odometry for i in (0, 1)]
    shares = [math.sqrt(alpha) for odometry in odometries for alpha in (odometry.alpha3, odometry.alpha1)]
    assert len(set(shares)) == 4
    assert max(shares[0], shares[2]) <= 0.015
    assert max(shares[1], shares[3]) <= 0.025
    again = world_of(ROOM + _with('localization "odom"') + second)
    assert again.scenario == found.scenario


def test_line_and_outline_that_crosses_itself_are_solid(world_of):
    """A line is 1 cm wide; of a bow tie of 2 x 2 m both triangles remain, 2 m2 in all."""
    line = "model( size [ 2 0.01 1 ] pose [ 5 6 0 0 ] block( points 2 point[0] [ 0 0 ] point[1] [ 1 0 ] z [ 0 1 ] ) )"
    corners = "point[0] [0 0] point[1] [1 1] point[2] [1 0] point[3] [0 1]"
    tie = f"model( size [ 2 2 1 ] pose [ 5 4 0 0 ] block( points 4 {corners} ) )"
    plan = world_of(ROOM + ROBOT + line + tie).plan
    strip, *triangles = [shapely.Polygon(block.polygon) for block in plan.blocks]
    assert (strip.area, len(triangles)) == (pytest.approx(0.0201), 2)
    assert sum(triangle.area for triangle in triangles) == pytest.approx(2.0)


def test_white_bitmap_is_nothing_and_a_tiny_one_a_box(world_of, tmp_path):
    cv2.imwrite(str(tmp_path / "white.png"), np.full((9, 9), 255, np.uint8))
    cv2.imwrite(str(tmp_path / "dark.png"), np.eye(900, dtype=np.uint8)[::-1] * 255)
    models = 'model( bitmap "white.png" ) model( bitmap "dark.png" size [0.5 0.5 1] pose [5 5 0 0] )'
    found = world_of(ROOM + ROBOT + models)
    assert "a.world:3: bitmap: no pixel is dark: nothing is solid, as in Stage" in found.notes
    assert [shapely.Polygon(block.polygon).area for block in found.plan.blocks] == pytest.approx([0.25])


def test_grey_pixels_are_solid_as_in_stage_on_request(world_of, tmp_path):
    """One of 4 x 4 pixels has red 120 and the lightness of free floor; in Stage, what is below 128 is solid."""
    picture = np.full((4, 4, 3), 255, np.uint8)
    picture[[0, 0, -1, -1], [0, -1, 0, -1]] = 0
    picture[0] = picture[-1] = 0
    picture[1, 1:3] = (255, 255, 120)
    cv2.imwrite(str(tmp_path / "grey.png"), picture)
    text = ROBOT.replace("2 2 0 0", "9 9 0 0") + 'model( bitmap "grey.png" size [ 4 4 1 ] )'
    by_default, as_stage = world_of(text), world_of(text, grey_as_stage=True)
    assert (_solid_m2(by_default.plan), _solid_m2(as_stage.plan)) == pytest.approx((8.0, 10.0))
    assert any("2 pixels neither black nor white" in note for note in by_default.notes)
    assert not any("pixel" in note for note in as_stage.notes)


def test_all_refusals_of_a_file_are_reported_at_once(world_of):
    robots = ROBOT.replace("2 2 0 0", "2 2") + 'model( bitmap "no.png" )\n' + ROBOT.replace("[ 0 5 ]", "[ 0 ]")
    text = f"{ROOM}puck()\n{robots}"
    with pytest.raises(ScenarioError) as refused:
        world_of(text)
    assert [str(refused.value), *refused.value.__notes__] == [
        "a.world:2: puck: unknown model 'puck'",
        "a.world:3: pose: [2 2] is not 4 numbers, [x y z heading]",
        "a.world:5: range: 0 is not 2 numbers, [low high]",
        "a.world:4: bitmap: there is no file 'no.png'",
    ]


def test_all_robots_without_room_are_reported_at_once(world_of):
    with pytest.raises(PlacementError) as refused:
        world_of(ROOM + ROBOT.replace("2 2 0 0", "0 2 0 0") + ROBOT + ROBOT.replace("2 2 0 0", "10 2 0 0"))
    lines = [str(refused.value), *refused.value.__notes__]
    assert [line.partition(": pose")[0] for line in lines] == ["a.world:2", "a.world:4"]


def test_equal_notes_are_one_line(world_of):
    robots = "".join(f"position( pose [ {x} 2 0 0 ] size [ 0.4 0.4 0.2 ] )\n" for x in range(2, 8))
    text = "'position' has no ranger; it gets the default laser, as every robot has one here (and 5 other lines)"
    assert world_of(ROOM + robots).notes == (f"a.world:2: {text}",)


def test_model_on_which_a_robot_stands_is_omitted(world_of):
    found = world_of(ROOM + "model( pose [ 8 6 0 0 ] position( size [ 0.4 0.4 0.2 ] ) )\n")
    assert (found.plan.blocks, _robot(found).start_pose) == ((), (8.0, 6.0, 0.0))
    assert "a.world:2: 'model' omitted: a robot stands on it" in found.notes
