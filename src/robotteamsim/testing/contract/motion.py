"""Every world: time, commands, limits, contacts."""

import math

import numpy as np
import pytest
import shapely

from robotteamsim.geometry import Pose, Twist
from robotteamsim.rng import stream
from robotteamsim.scenario.drives import CarDrive, Drive, OmniDrive
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import PlacedRobot

FORWARD = Twist(0.5)
TOUCH_M = 0.01


def drive(world, *twists, steps):
    for _ in range(steps):
        world.step(twists)


def test_time_is_counted_in_whole_steps(world_of):
    world = world_of((2.0, 2.0, 0.0))
    assert (world.num_robots, world.step_ns, world.step_index, world.sim_time_ns) == (1, 100_000_000, 0, 0)
    drive(world, Twist(), steps=3)
    assert (world.step_index, world.sim_time_ns) == (3, 300_000_000)


@pytest.mark.parametrize(
    "form",
    [
        {},
        {"drive": OmniDrive(kind="omni")},
        {"drive": CarDrive(kind="car", wheelbase_m=0.2, max_steering_rad=0.6)},
        {"footprint_m": ((-0.1, -0.2), (0.4, -0.2), (0.5, 0.0), (0.4, 0.2), (-0.1, 0.2)), "mass_kg": 30.0},
    ],
    ids=["differential", "omni", "car", "polygon"],
)
def test_robots_without_a_command_stay_where_they_are_placed(world_of, form):
    world = world_of(PlacedRobot(start_pose=(2.1, 2.3, 0.7), **form))
    drive(world, Twist(), steps=50)
    pose = world.poses()[0]
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((2.1, 2.3, 0.7), abs=2e-3)
    assert world.in_contact() == [False]
    assert world.contact_angles_rad() == {}


@pytest.mark.parametrize(
    ("form", "command", "after_4_s"),
    [
        ({}, Twist(0.5), (2.0, 0.0, 0.0)),
        ({}, Twist(-0.3), (-1.2, 0.0, 0.0)),
        ({}, Twist(0.0, 0.0, 1.0), (0.0, 0.0, 4.0 - math.tau)),
        ({}, Twist(0.2, 0.0, 0.5), (0.4 * math.sin(2.0), 0.4 * (1.0 - math.cos(2.0)), 2.0)),
        ({"drive": OmniDrive(kind="omni")}, Twist(0.3, 0.4), (1.2, 1.6, 0.0)),
        (
            {"drive": OmniDrive(kind="omni")},
            Twist(0.0, 0.2, 0.5),
            (-0.4 * (1.0 - math.cos(2.0)), 0.4 * math.sin(2.0), 2.0),
        ),
        (
            {"drive": CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.8)},
            Twist(0.3, 0.0, 0.5),
            (0.6 * math.sin(2.0), 0.6 * (1.0 - math.cos(2.0)), 2.0),
        ),
    ],
    ids=["forward", "backward", "turn", "arc", "omni straight", "omni turning", "car"],
)
def test_drives_follow_their_commands(world_of, form, command, after_4_s):
    limits = {"max_acceleration_mps2": 20.0, "max_turn_acceleration_radps2": 80.0}
    form = form or {"drive": Drive(**limits)}
    start = (3.0, 2.0, 0.0)
    world = world_of(PlacedRobot(start_pose=start, **form))
    drive(world, command, steps=40)
    moved = Pose(*start).inverse() @ world.poses()[0]
    # A tenth of a second passes until a drive has its speed, and wheels slip a little.
    assert (moved.x_m, moved.y_m, moved.yaw_rad) == pytest.approx(after_4_s, abs=0.13)


def test_differential_drive_ignores_a_command_to_the_side(world_of):
    world = world_of((2.0, 2.0, 0.0))
    drive(world, Twist(0.0, 0.5, 0.0), steps=20)
    assert (world.poses()[0].x_m, world.poses()[0].y_m) == pytest.approx((2.0, 2.0), abs=2e-3)


def test_car_does_not_turn_on_the_spot(world_of):
    world = world_of(
        PlacedRobot(start_pose=(2.0, 2.0, 0.0), drive=CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.6))
    )
    drive(world, Twist(0.0, 0.0, 1.0), steps=20)
    assert world.poses()[0].yaw_rad == pytest.approx(0.0, abs=5e-3)


def test_speeds_and_accelerations_stay_within_the_drive(world_of):
    limits = Drive(max_speed_mps=0.4, max_turn_radps=1.0, max_acceleration_mps2=1.0, max_turn_acceleration_radps2=2.0)
    world = world_of(PlacedRobot(start_pose=(2.0, 2.0, 0.0), drive=limits))
    last = Twist()
    for _ in range(14):
        world.step([Twist(9.0, 0.0, 9.0)])
        twist = world.twists()[0]
        assert -1e-9 <= twist.linear_x_mps <= 0.4 * 1.02
        assert twist.linear_x_mps - last.linear_x_mps <= 0.1 * 1.1
        assert twist.angular_z_radps - last.angular_z_radps <= 0.2 * 1.1
        last = twist
    assert last.linear_x_mps == pytest.approx(0.4, rel=0.03)
    assert last.angular_z_radps == pytest.approx(1.0, rel=0.03)


def test_robot_brakes_when_its_command_ends(world_of):
    world = world_of((1.0, 2.0, 0.0))
    drive(world, FORWARD, steps=20)
    before = world.poses()[0].x_m
    drive(world, Twist(), steps=10)
    # v^2 / 2a, and the response of motors.
    assert world.poses()[0].x_m - before == pytest.approx(0.5**2 / 4.0, abs=0.03)
    assert world.twists()[0].linear_x_mps == pytest.approx(0.0, abs=2e-3)


def test_motion_is_the_distance_between_consecutive_poses(world_of):
    world = world_of((3.0, 2.0, 0.4))
    drive(world, Twist(0.4, 0.0, 0.6), steps=10)
    before = world.poses()[0]
    drive(world, Twist(0.4, 0.0, 0.6), steps=1)
    motion, twist, after = world.motions()[0], world.twists()[0], world.poses()[0]
    reached = before @ motion
    assert (reached.x_m, reached.y_m, reached.yaw_rad) == pytest.approx((after.x_m, after.y_m, after.yaw_rad), abs=1e-9)
    assert (twist.linear_x_mps, twist.angular_z_radps) == pytest.approx((0.4, 0.6), rel=0.05)


@pytest.mark.parametrize(
    ("start", "blocked_at"),
    [
        ((5.0, 1.5, 0.0), (5.75, 1.5)),
        ((7.4, 2.0, 0.0), (7.8, 2.0)),
        ((8.9, 2.3, math.pi), (8.7, 2.3)),
        ((9.0, 2.2, -math.pi / 2), (9.0, 1.7)),
    ],
    ids=["wall", "block", "inner side of a block", "other inner side"],
)
def test_walls_and_blocks_stop_a_robot(world_of, start, blocked_at):
    world = world_of(start)
    drive(world, FORWARD, steps=40)
    assert (world.poses()[0].x_m, world.poses()[0].y_m) == pytest.approx(blocked_at, abs=TOUCH_M)
    assert world.twists()[0].linear_x_mps == pytest.approx(0.0, abs=5e-3)
    assert world.in_contact() == [True]
    assert world.contact_angles_rad() == {0: pytest.approx((0.0,), abs=0.15)}


def test_robot_that_meets_a_wall_at_an_angle_touches_it_there(world_of):
    world = world_of((2.0, 0.6, -0.5))
    drive(world, FORWARD, steps=30)
    pose = world.poses()[0]
    assert pose.y_m == pytest.approx(0.4, abs=TOUCH_M)
    assert world.contact_angles_rad() == {0: pytest.approx((-0.5 * math.pi - pose.yaw_rad,), abs=0.05)}


def test_robot_comes_free_again(world_of):
    world = world_of((5.5, 1.5, 0.0))
    drive(world, FORWARD, steps=20)
    drive(world, Twist(-0.5), steps=20)
    assert world.poses()[0].x_m == pytest.approx(5.75 - 1.0, abs=0.15)
    assert world.in_contact() == [False]


def test_robots_do_not_pass_through_each_other(world_of):
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, math.pi))
    drive(world, FORWARD, FORWARD, steps=50)
    first, second = world.poses()
    assert second.x_m - first.x_m == pytest.approx(0.4, abs=TOUCH_M)
    assert world.in_contact() == [True, True]


def test_no_robot_enters_a_solid_under_any_commands(world_of):
    world = world_of(*((1.0 + i % 4, 1.0 + i // 4, math.remainder(i, math.tau)) for i in range(8)))
    solids = obstacles(world.plan)
    generator = stream(2, "contract of worlds")
    for step in range(600):
        if step % 15 == 0:
            twists = generator.uniform((-0.7, 0.0, -2.0), (0.7, 0.0, 2.0), (8, 3))
        world.step(twists)
        distances_m = shapely.distance(solids, shapely.points(world.positions_m()))
        assert distances_m.min() > 0.2 - 0.015, f"step {step}"
    assert world.mishaps == {}


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_command_that_is_not_finite_is_rejected_and_nothing_moves(world_of, value):
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0))
    drive(world, FORWARD, FORWARD, steps=3)
    before = world.poses()
    with pytest.raises(ValueError, match=r"^robot_1: twist must be finite"):
        world.step([FORWARD, Twist(value)])
    assert (world.poses(), world.step_index) == (before, 3)


@pytest.mark.parametrize("count", [0, 1, 3])
def test_wrong_number_of_commands_is_rejected(world_of, count):
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0))
    with pytest.raises(ValueError, match=rf"^expected 2 twists, got {count}$"):
        world.step([FORWARD] * count)
    assert world.step_index == 0


def test_array_of_commands_is_as_good_as_a_list(world_of):
    one, other = world_of((2.0, 2.0, 0.0)), world_of((2.0, 2.0, 0.0))
    drive(one, Twist(0.3, 0.0, 0.4), steps=5)
    for _ in range(5):
        other.step(np.array([[0.3, 0.0, 0.4]]))
    assert one.poses() == other.poses()
