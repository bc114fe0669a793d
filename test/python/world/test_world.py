import numpy as np
import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.testing.contract.two_rooms import two_rooms
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


def bits(world: World) -> bytes:
    return np.array([(pose.x_m, pose.y_m, pose.yaw_rad) for pose in world.poses()]).tobytes()


def test_robots_start_exactly_at_their_poses():
    world = world_of((2.1, 3.3, 0.7), (4.7, 1.9, -3.0))
    drive(world, Twist(), Twist(), steps=5)
    assert world.poses() == [Pose(2.1, 3.3, 0.7), Pose(4.7, 1.9, -3.0)]
    assert world.positions_m().tolist() == [[2.1, 3.3], [4.7, 1.9]]
    assert world.in_contact() == [False, False]


def test_closing_door_pushes_a_robot_aside():
    world = world_of((5.9, 3.0, 0.0))
    world.set_door("gate", True)
    drive(world, Twist(), steps=20)
    assert world.poses()[0].x_m == pytest.approx(5.77, abs=TOUCH_M)
    assert world.poses()[0].y_m == pytest.approx(3.0, abs=TOUCH_M)


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
def test_start_poses_without_room_are_rejected(poses, message):
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


def test_invalid_command_is_rejected_and_nothing_moves():
    world, untouched = world_of((2.0, 2.0, 0.0)), world_of((2.0, 2.0, 0.0))
    for wrong in (0.5, (0.5, 0.0), Twist("fast", 0.0, 0.0)):
        with pytest.raises(TypeError, match="incompatible function arguments"):
            world.step([wrong])
    assert bits(world) == bits(untouched)
