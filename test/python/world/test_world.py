import math

import numpy as np
import pytest
import shapely
from two_rooms import two_rooms

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Drive, PlacedRobot, Run
from robotteamsim.world import World

RUN = Run()
FORWARD = Twist(0.7)
TOUCH_M = 0.005
PLAN = two_rooms()


def world_of(*poses: tuple[float, float, float], run: Run = RUN, plan: FloorPlan = PLAN) -> World:
    return World(plan, [PlacedRobot(start_pose=pose) for pose in poses], run)


def drive(world: World, *twists: Twist, steps: int) -> None:
    for _ in range(steps):
        world.step(twists)


def random_twists(generator: np.random.Generator, count: int) -> list[Twist]:
    return [Twist(generator.choice([-0.7, 0.7, 0.7]), 0.0, generator.uniform(-2.0, 2.0)) for _ in range(count)]


def bits(world: World) -> bytes:
    return np.array([(pose.x_m, pose.y_m, pose.yaw_rad) for pose in world.poses()]).tobytes()


def test_time_is_counted_in_whole_steps():
    world = world_of((2.0, 2.0, 0.0), run=Run(step_s=0.1))
    assert (world.num_robots, world.step_index, world.sim_time_ns) == (1, 0, 0)
    drive(world, Twist(), steps=3)
    assert (world.step_index, world.sim_time_ns) == (3, 300_000_000)


def test_robots_stand_exactly_where_they_are_placed():
    world = world_of((2.1, 3.3, 0.7), (4.7, 1.9, -3.0))
    drive(world, Twist(), Twist(), steps=5)
    assert world.poses() == [Pose(2.1, 3.3, 0.7), Pose(4.7, 1.9, -3.0)]
    assert world.positions_m().tolist() == [[2.1, 3.3], [4.7, 1.9]]
    assert world.in_contact() == [False, False]


def test_free_robot_moves_as_commanded_and_says_so():
    world = world_of((1.0, 2.0, 0.0))
    drive(world, Twist(0.5, 0.3, 0.0), steps=10)
    before = world.poses()[0]
    drive(world, Twist(0.5, 0.3, 0.0), steps=1)
    assert world.poses()[0].x_m - before.x_m == pytest.approx(0.05, abs=1e-12)
    assert world.twists()[0].linear_x_mps == pytest.approx(0.5, abs=1e-12)
    assert world.twists()[0].linear_y_mps == 0.0
    assert world.motions()[0].x_m == pytest.approx(0.05, abs=1e-12)


def test_speeds_and_accelerations_keep_to_the_drive():
    limits = Drive(max_speed_mps=0.4, max_turn_radps=1.0, max_acceleration_mps2=1.0, max_turn_acceleration_radps2=2.0)
    world = World(PLAN, [PlacedRobot(start_pose=(2.0, 2.0, 0.0), drive=limits)], RUN)
    last = Twist()
    for _ in range(12):
        world.step([Twist(9.0, 0.0, 9.0)])
        twist = world.twists()[0]
        assert 0.0 <= twist.linear_x_mps - last.linear_x_mps <= 0.1 + 1e-12
        assert 0.0 <= twist.angular_z_radps - last.angular_z_radps <= 0.2 + 1e-12
        last = twist
    assert last.linear_x_mps == pytest.approx(0.4)
    assert last.angular_z_radps == pytest.approx(1.0)


def test_blocked_robot_has_no_twist():
    world = world_of((5.0, 1.5, 0.0))
    drive(world, FORWARD, steps=30)
    assert world.poses()[0].x_m == pytest.approx(5.75, abs=TOUCH_M)
    assert world.twists()[0].linear_x_mps == pytest.approx(0.0, abs=1e-6)
    assert world.in_contact() == [True]


@pytest.mark.parametrize(
    ("start", "blocked_at"),
    [((8.9, 2.3, math.pi), (8.7, 2.3)), ((9.0, 2.2, -math.pi / 2), (9.0, 1.7)), ((7.5, 2.0, 0.0), (7.8, 2.0))],
)
def test_blocks_that_are_not_convex_are_solid_along_their_outline(start, blocked_at):
    world = world_of(start)
    drive(world, FORWARD, steps=20)
    assert (world.poses()[0].x_m, world.poses()[0].y_m) == pytest.approx(blocked_at, abs=TOUCH_M)


def test_robots_do_not_pass_through_each_other():
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, math.pi))
    drive(world, FORWARD, FORWARD, steps=40)
    first, second = world.poses()
    assert second.x_m - first.x_m == pytest.approx(0.4, abs=TOUCH_M)
    assert world.in_contact() == [True, True]


def test_no_robot_enters_a_solid_whatever_the_commands():
    world = world_of(*((1.0 + i % 4, 1.0 + i // 4, i) for i in range(8)))
    solid = obstacles(PLAN)
    generator = np.random.default_rng(2)
    for step in range(3000):
        if step % 15 == 0:
            twists = random_twists(generator, 8)
        world.step(twists)
        distances_m = shapely.distance(solid, shapely.points(world.positions_m()))
        assert distances_m.min() > 0.2 - 0.012, f"step {step}"


def test_fast_robot_does_not_tunnel_through_a_thin_wall():
    plan = FloorPlan(
        name="sheet",
        bounds=Bounds(max=(40.0, 4.0)),
        walls=(Wall(name="sheet", start=(30.0, 0.0), end=(30.0, 4.0), thickness_m=0.002),),
    )
    drive_limits = Drive(max_speed_mps=10.0, max_acceleration_mps2=50.0)
    robot = PlacedRobot(start_pose=(1.0, 2.0, 0.0), radius_m=0.05, drive=drive_limits)
    world = World(plan, [robot], Run(step_s=1.0, physics_substeps=1))
    drive(world, Twist(10.0), steps=6)
    assert world.poses()[0].x_m == pytest.approx(29.949, abs=2 * TOUCH_M)


def test_doors_stop_robots_only_while_closed():
    world = world_of((5.0, 3.0, 0.0))
    assert world.door_states().closed() == {"gate": False}
    world.set_door("gate", True)
    drive(world, FORWARD, steps=20)
    assert world.door_states().closed() == {"gate": True}
    assert world.poses()[0].x_m == pytest.approx(5.77, abs=TOUCH_M)
    world.set_door("gate", False)
    drive(world, FORWARD, steps=20)
    assert world.poses()[0].x_m > 6.5


def test_closing_door_pushes_a_robot_aside():
    world = world_of((5.9, 3.0, 0.0))
    world.set_door("gate", True)
    drive(world, Twist(), steps=20)
    assert world.poses()[0].x_m == pytest.approx(5.77, abs=TOUCH_M)
    assert world.poses()[0].y_m == pytest.approx(3.0, abs=TOUCH_M)


def test_two_worlds_with_the_same_commands_are_equal_to_the_bit_and_so_is_a_rerun():
    starts = [(1.0 + i % 4, 1.0 + i // 4, i) for i in range(8)]
    first, second = world_of(*starts), world_of(*starts)
    generator = np.random.default_rng(3)
    script = [random_twists(generator, 8) for _ in range(500)]
    record = []
    for twists in script:
        first.step(twists)
        second.step(twists)
        record.append(bits(first))
        assert bits(second) == record[-1]
    first.set_door("gate", True)
    first.set_pose(0, Pose(7.0, 5.0, 1.0))
    first.reset()
    assert (first.step_index, first.door_states().closed()) == (0, {"gate": False})
    for twists, expected in zip(script, record, strict=True):
        first.step(twists)
        assert bits(first) == expected


def test_reset_positions_puts_robots_back_but_not_time_or_doors():
    world = world_of((2.0, 2.0, 0.5))
    world.set_door("gate", True)
    drive(world, FORWARD, steps=10)
    world.reset_positions()
    assert world.poses() == [Pose(2.0, 2.0, 0.5)]
    assert (world.step_index, world.door_states().closed()) == (10, {"gate": True})
    drive(world, Twist(), steps=1)
    assert world.poses() == [Pose(2.0, 2.0, 0.5)]


def test_set_pose_moves_a_robot_that_then_feels_the_walls_there():
    world = world_of((2.0, 2.0, 0.0))
    drive(world, FORWARD, steps=10)
    world.set_pose(0, Pose(11.0, 5.0, 3 * math.pi))
    assert (world.poses()[0].x_m, world.poses()[0].y_m) == (11.0, 5.0)
    assert world.poses()[0].yaw_rad == pytest.approx(math.pi)
    assert world.motions() == [Pose(0.0, 0.0, 0.0)]
    drive(world, Twist(-0.7), steps=30)
    assert world.poses()[0].x_m == pytest.approx(11.6, abs=TOUCH_M)


def test_robot_may_start_touching_a_wall_or_a_robot():
    world_of((0.4, 0.4, 0.0), (0.8, 0.4, 0.0))


@pytest.mark.parametrize(
    ("poses", "message"),
    [
        (
            [(2.0, 2.0, 0.0), (4.0, 5.9, 0.0)],
            "robot_1: start pose (4.00, 5.90) is inside wall 'north'; expected 0.2 m of clearance",
        ),
        (
            [(7.85, 2.0, 0.0)],
            "robot_0: start pose (7.85, 2.00) is inside block 'core'; expected 0.2 m of clearance",
        ),
        (
            [(2.0, 2.0, 0.0), (4.0, 2.0, 0.0), (2.3, 2.0, 1.0)],
            "robot_2: start pose (2.30, 2.00) is inside robot_0 at (2.00, 2.00); expected 0.4 m between them",
        ),
        ([(13.0, 2.0, 0.0)], "robot_0: start pose (13.00, 2.00) is outside the plan, [0, 0] .. [12, 6]"),
    ],
    ids=["wall", "block", "robot", "outside"],
)
def test_robot_that_starts_where_it_cannot_stand_is_refused(poses, message):
    with pytest.raises(PlacementError) as error:
        world_of(*poses)
    assert str(error.value) == message


def test_robot_can_be_put_into_an_open_door_but_not_into_a_closed_one():
    world = world_of((2.0, 2.0, 0.0))
    world.set_pose(0, Pose(6.0, 3.0, 0.0))
    world.set_pose(0, Pose(2.0, 2.0, 0.0))
    world.set_door("gate", True)
    with pytest.raises(PlacementError, match=r"robot_0: pose \(6.00, 3.00\) is inside door 'gate'"):
        world.set_pose(0, Pose(6.0, 3.0, 0.0))
    assert world.poses() == [Pose(2.0, 2.0, 0.0)]


def test_twist_that_is_not_finite_is_refused_and_nothing_moves():
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0))
    with pytest.raises(ValueError, match=r"robot_1: twist must be finite, got \(0.1\d*, 0.0\d*, nan\)"):
        world.step([FORWARD, Twist(0.1, 0.0, math.nan)])
    with pytest.raises(ValueError, match="expected 2 twists, got 1"):
        world.step([FORWARD])
    assert (world.step_index, world.poses()[0]) == (0, Pose(2.0, 2.0, 0.0))


def test_unknown_doors_and_robots_are_refused():
    world = world_of((2.0, 2.0, 0.0))
    with pytest.raises(ValueError, match="unknown door 'gat'; known: gate"):
        world.set_door("gat", True)
    with pytest.raises(ValueError, match=r"robot_id must be in 0..0, got 1"):
        world.set_pose(1, Pose(2.0, 2.0, 0.0))
    with pytest.raises(ValueError, match="robot_0: pose must be finite"):
        world.set_pose(0, Pose(2.0, math.nan, 0.0))


def test_a_command_that_is_no_twist_is_refused_and_nothing_moves():
    world, untouched = world_of((2.0, 2.0, 0.0)), world_of((2.0, 2.0, 0.0))
    for wrong in (0.5, (0.5, 0.0), Twist("fast", 0.0, 0.0)):
        with pytest.raises(TypeError, match="incompatible function arguments"):
            world.step([wrong])
    assert bits(world) == bits(untouched)
