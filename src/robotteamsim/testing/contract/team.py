"""Every world: robots that are moved, leave and arrive; determinism and reset."""

import math

import numpy as np
import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Laser, PlacedRobot
from robotteamsim.scenario.sensors import LightSensor, Sonar
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation.stages import ScheduleStage

FORWARD, STOP = Twist(0.5), Twist()
BOX = MovableObject(name="box", size_m=(0.4, 0.4), pose=(3.0, 2.0, 0.3), mass_kg=1.0)
DRUM = MovableObject(name="drum", kind="barrel", radius_m=0.3, pose=(4.5, 2.8, 0.0), mass_kg=1.0)
BEAM = Laser(beams=3, angle_min_rad=-0.2, angle_max_rad=0.2, forward_m=0.0, range_max_m=8.0)


def drive(world, *twists, steps):
    for _ in range(steps):
        world.step(twists)


def test_teleported_robot_is_at_rest_and_did_not_move(world_of):
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0))
    drive(world, FORWARD, STOP, steps=10)
    world.set_pose(0, Pose(9.0, 4.0, 1.5))
    assert world.poses()[0] == Pose(9.0, 4.0, pytest.approx(1.5, abs=1e-12))
    assert world.twists()[0] == Twist()
    assert world.motions()[0] == Pose(0.0, 0.0, 0.0)
    drive(world, STOP, STOP, steps=5)
    pose = world.poses()[0]
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((9.0, 4.0, 1.5), abs=2e-3)


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        ((6.0, 1.0, 0.0), "is inside wall 'middle south'"),
        ((4.1, 2.0, 0.0), "is inside robot_1"),
        ((13.0, 1.0, 0.0), "is outside the plan"),
        ((8.2, 2.9, 0.0), "is inside block 'core'"),
        ((3.1, 2.0, 0.0), "is inside box 'box'"),
    ],
)
def test_robot_is_neither_teleported_nor_spawned_into_an_obstacle(world_of, pose, message):
    absent = PlacedRobot(start_pose=(2.0, 4.0, 0.0), present=False)
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0), absent, objects=(BOX,))
    for robot_id, call in ((0, world.set_pose), (2, world.spawn_robot)):
        with pytest.raises(PlacementError, match=rf"^robot_{robot_id}: pose .* {message}"):
            call(robot_id, Pose(*pose))
    assert (world.poses()[0].x_m, world.poses()[0].y_m) == (2.0, 2.0)
    assert world.present.tolist() == [True, True, False]


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_pose_that_is_not_finite_is_rejected(world_of, value):
    world = world_of((2.0, 2.0, 0.0), PlacedRobot(start_pose=(4.0, 2.0, 0.0), present=False))
    for call in (world.set_pose, world.spawn_robot):
        with pytest.raises(ValueError, match=r"must be finite"):
            call(int(call == world.spawn_robot), Pose(1.0, value, 0.0))


def test_absent_robot_has_no_body_and_no_pose(world_of, readings_of):
    robots = (
        PlacedRobot(start_pose=(2.0, 2.0, 0.0), laser=BEAM),
        PlacedRobot(start_pose=(3.0, 2.0, 0.0), laser=BEAM, present=False),
    )
    world = world_of(*robots)
    assert world.present.tolist() == [True, False]
    assert world.arrivals == (1, 0)
    assert math.isnan(world.poses()[1].x_m)
    assert readings_of(world, robots)[0].ranges_m[1] == pytest.approx(3.95, abs=0.01)
    drive(world, FORWARD, FORWARD, steps=40)
    assert world.poses()[0].x_m > 3.5
    assert math.isnan(world.positions_m()[1, 0])


def test_robots_leave_and_arrive_again(world_of):
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0))
    assert (world.present.tolist(), world.arrivals) == ([True, True], (1, 1))
    drive(world, FORWARD, STOP, steps=10)
    before = world.poses()[0]
    world.remove_robot(1)
    assert world.poses()[0] == before
    assert (world.present.tolist(), world.arrivals) == ([True, False], (1, 1))
    drive(world, FORWARD, STOP, steps=1)
    assert world.twists()[0].linear_x_mps == pytest.approx(0.5, rel=0.05)
    assert (world.twists()[1], world.motions()[1], world.in_contact()[1]) == (Twist(), Pose(0.0, 0.0, 0.0), False)
    world.spawn_robot(1, Pose(9.0, 4.0, 1.0))
    assert (world.present.tolist(), world.arrivals) == ([True, True], (1, 2))
    assert world.poses()[1] == Pose(9.0, 4.0, pytest.approx(1.0, abs=1e-12))
    world.remove_robot(1)
    world.spawn_robot(1)
    assert world.positions_m()[1].tolist() == [4.0, 2.0]


def test_removed_robot_blocks_nobody_and_can_return(world_of):
    world = world_of((2.0, 2.0, 0.0), (3.0, 2.0, 0.0))
    world.remove_robot(1)
    drive(world, FORWARD, STOP, steps=30)
    assert (world.present.tolist(), world.arrivals) == ([True, False], (1, 1))
    assert world.poses()[0].x_m > 3.2
    assert math.isnan(world.poses()[1].x_m)
    world.spawn_robot(1, Pose(9.0, 4.0, 1.0))
    drive(world, STOP, STOP, steps=2)
    assert (world.present.tolist(), world.arrivals) == ([True, True], (1, 2))
    pose = world.poses()[1]
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((9.0, 4.0, 1.0), abs=2e-3)


def test_mistakes_about_presence_are_named(world_of):
    world = world_of((2.0, 2.0, 0.0), PlacedRobot(start_pose=(4.0, 2.0, 0.0), present=False))
    with pytest.raises(ValueError, match=r"^robot_0 is already present; it cannot be spawned$"):
        world.spawn_robot(0)
    with pytest.raises(ValueError, match=r"^robot_1 is not present; it cannot be removed$"):
        world.remove_robot(1)
    with pytest.raises(ValueError, match=r"^robot_1 is not present; it cannot be moved$"):
        world.set_pose(1, Pose(1.0, 1.0, 0.0))
    with pytest.raises(ValueError, match=r"^robot_id must be in 0\.\.1, got 2$"):
        world.remove_robot(2)
    with pytest.raises(ValueError, match=r"^robot_id must be in 0\.\.1, got -1$"):
        world.spawn_robot(-1)
    with pytest.raises(ValueError, match=r"^robot_id must be in 0\.\.1, got 2$"):
        world.set_pose(2, Pose(1.0, 1.0, 0.0))


def test_schedule_moves_robots_and_doors(world_of):
    schedule = (
        ScheduledEvent(at_s=0.5, spawn=0, pose=(9.0, 4.0, 0.0)),
        ScheduledEvent(at_s=0.2, remove=0),
        ScheduledEvent(at_s=0.3, door="gate", closed=True),
    )
    world = world_of((2.0, 2.0, 0.0), (4.0, 2.0, 0.0))
    seen, stage = [], ScheduleStage(schedule)
    for _ in range(6):
        stage.step(world.sim_time_ns, world)
        world.step([STOP, STOP])
        seen.append((bool(world.present.all()), world.door_states()["gate"].closed))
    assert seen == [(True, False)] * 2 + [(False, False), (False, True), (False, True), (True, True)]
    assert world.positions_m()[0].tolist() == pytest.approx([9.0, 4.0], abs=2e-3)


def course(world, robots):
    """Drive, push, remove, spawn; return the bits of everything that can be read."""
    sensors, rows = RobotSensors(world, robots, 1), []
    for step in range(60):
        if step == 20:
            world.remove_robot(2)
            world.spawn_robot(3)
            world.set_door("gate", closed=True)
            world.add_object(DRUM)
        if step == 40:
            world.remove_object("drum")
            world.spawn_robot(2, Pose(9.0, 4.0, 0.5))
            world.move_object("box", Pose(4.0, 4.0, 0.0))
        world.step([Twist(0.5, 0.0, 0.1), Twist(-0.4, 0.0, math.sin(step)), Twist(0.3, 0.0, 0.5), FORWARD])
        state = sensors.read()
        poses = [(pose.x_m, pose.y_m, pose.yaw_rad) for pose in world.objects().values()]
        of_odometry = state.odometry_pose, state.odometry_twist
        of_odometry += state.odometry_pose_covariance, state.odometry_twist_variances
        for part in (state.true_pose, state.true_twist, state.contact, *of_odometry, np.array(poses)):
            rows.append(part.tobytes())
        rows += [state.ranges_m.tobytes(), repr([robot.contact_angles_rad for robot in state.readings()])]
    return rows


def test_equal_calls_give_equal_worlds_also_after_a_reset(world_of):
    robots = tuple(PlacedRobot(start_pose=pose) for pose in ((2.0, 2.0, 0.0), (4.5, 2.2, 0.0), (9.0, 4.5, 0.0)))
    robots += (PlacedRobot(start_pose=(2.0, 5.0, 0.0), present=False),)
    keys = {"objects": (BOX,), "door": {"motion": "swing"}}
    world = world_of(*robots, **keys)
    first = course(world, robots)
    assert course(world_of(*robots, **keys), robots) == first
    world.remove_robot(0)
    world.reset()
    assert world.present.tolist() == [True, True, True, False]
    assert list(world.objects()) == ["box"]
    assert (world.step_index, world.sim_time_ns, world.arrivals) == (0, 0, (1, 1, 1, 0))
    assert course(world, robots) == first


def test_reset_of_positions_keeps_time_doors_objects_and_presence(world_of):
    world = world_of((2.0, 2.0, 0.0), (9.0, 4.0, 0.0), objects=(BOX,))
    world.set_door("gate", closed=True)
    world.remove_robot(1)
    drive(world, FORWARD, STOP, steps=20)
    pushed = world.objects()["box"]
    world.reset_positions()
    assert world.poses()[0] == Pose(2.0, 2.0, 0.0)
    assert world.present.tolist() == [True, False]
    assert (world.objects()["box"], world.step_index) == (pushed, 20)
    assert world.door_states()["gate"].closed


def test_lasers_see_walls_objects_and_robots(world_of, readings_of):
    robots = tuple(PlacedRobot(start_pose=(1.5, y, 0.0), laser=BEAM) for y in (1.0, 2.0, 3.25))
    robots += (PlacedRobot(start_pose=(4.0, 3.25, 0.0), laser=BEAM),)
    world = world_of(*robots, objects=(BOX.model_copy(update={"pose": (3.0, 2.0, 0.0)}),))
    readings = readings_of(world, robots)
    assert [reading.ranges_m[1] for reading in list(readings)[:3]] == pytest.approx([4.45, 1.3, 2.3], abs=0.01)
    assert readings[0].ranges_m.dtype == np.float32
    assert readings[3].ranges_m[1] == pytest.approx(7.8, abs=0.01)  # through the open gate to the east wall


def test_lasers_see_a_closed_door_and_not_an_open_one(world_of, readings_of):
    robots = (PlacedRobot(start_pose=(4.0, 3.25, 0.0), laser=BEAM),)
    world = world_of(*robots)
    world.set_door("gate", closed=True)
    assert readings_of(world, robots)[0].ranges_m[1] == pytest.approx(1.97, abs=0.01)
    world.set_door("gate", closed=False)
    assert readings_of(world, robots)[0].ranges_m[1] == pytest.approx(7.8, abs=0.01)


def test_sonar_reads_the_nearest_return_of_its_cone(world_of, readings_of):
    sonar = Sonar(name="front", forward_m=0.2, opening_rad=0.6, rays=61)
    robots = (PlacedRobot(start_pose=(3.25, 2.0, math.pi / 2.0), sensors=(sonar,)),)
    reading = readings_of(world_of(*robots), robots)[0]
    assert reading.sensors[sonar.name] == pytest.approx(1.8, abs=0.01)


def test_world_without_lights_is_dark(world_of):
    world = world_of((2.0, 2.0, 0.0))
    assert world.illuminance_lx(0, LightSensor(name="light")) == 0.0
