import math

import numpy as np
import pytest
from lasers import LaserBeams

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.rng import stream
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.sections import Laser, Odometry, PlacedRobot, Run
from robotteamsim.scenario.sensors import MountedLaser
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

PLAN = FloorPlan(
    name="wall", bounds=Bounds(max=(20.0, 10.0)), walls=(Wall(name="w", start=(6.1, 1.0), end=(6.1, 9.0)),)
)
REAR = MountedLaser(name="rear", beams=5, noise_m=0.05)
DRIFT = Odometry(alpha1=0.1, alpha2=0.1, alpha3=0.1, alpha4=0.1)


def team(count: int = 2, odometry: Odometry = DRIFT, laser: Laser | None = None) -> list[PlacedRobot]:
    keys = {"odometry": odometry, "laser": laser or Laser(noise_m=0.01), "sensors": (REAR,)}
    return [PlacedRobot(start_pose=(4.0, 2.0 + i, 0.0), **keys) for i in range(count)]


def run(robots: list[PlacedRobot], steps: int, seed: int = 1) -> tuple[World, RobotSensors, list[list[RobotReading]]]:
    world = World(PLAN, robots, Run())
    sensors = RobotSensors(world, robots, seed)
    return world, sensors, drive(world, sensors, steps)


def drive(world: World, sensors: RobotSensors, steps: int) -> list[list[RobotReading]]:
    record = []
    for step in range(steps):
        world.step([Twist(0.5, 0.0, math.sin(0.1 * step))] * world.num_robots)
        record.append(sensors.read())
    return record


def same(first: list[list[RobotReading]], second: list[list[RobotReading]]) -> bool:
    return all(
        (a.ground_truth, a.twist, a.odometry, a.in_contact) == (b.ground_truth, b.twist, b.odometry, b.in_contact)
        and np.array_equal(a.ranges_m, b.ranges_m)
        and np.array_equal(a.sensors["rear"], b.sensors["rear"])
        for before, after in zip(first, second, strict=True)
        for a, b in zip(before, after, strict=True)
    )


def test_reading_contains_the_values_of_the_world():
    world, _, record = run(team(), steps=5)
    reading = record[-1][1]
    assert reading.ground_truth == PoseReading.from_pose(world.poses()[1])
    assert reading.twist == world.twists()[1]
    assert reading.in_contact is False
    assert (reading.ranges_m.dtype, reading.ranges_m.shape) == (np.float32, (181,))


def test_odometry_of_a_blocked_robot_does_not_move():
    robots = [PlacedRobot(start_pose=(5.5, 5.0, 0.0), odometry=DRIFT)]
    world = World(PLAN, robots, Run())
    sensors = RobotSensors(world, robots, 1)
    for _ in range(30):
        world.step([Twist(0.7)])
        blocked = sensors.read()[0]
    for _ in range(100):
        world.step([Twist(0.7)])
        reading = sensors.read()[0]
    assert reading.in_contact is True
    assert reading.odometry.pose.x_m == pytest.approx(blocked.odometry.pose.x_m, abs=1e-5)
    assert reading.odometry.pose.y_m == pytest.approx(blocked.odometry.pose.y_m, abs=1e-5)
    assert reading.odometry.pose.qz == pytest.approx(blocked.odometry.pose.qz, abs=1e-5)
    assert reading.odometry.twist.linear_x_mps == pytest.approx(0.0, abs=1e-4)
    assert blocked.odometry.pose_covariance[0] > 1e-4
    assert reading.odometry.pose_covariance == pytest.approx(blocked.odometry.pose_covariance, rel=1e-5)
    assert reading.odometry.twist_variances == pytest.approx((0.0, 0.0, 0.0), abs=1e-8)


def test_exact_odometry_starts_where_the_robot_does_and_follows_it():
    exact = Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
    world, _, record = run([PlacedRobot(start_pose=(10.0, 5.0, 2.0), odometry=exact)], steps=60)
    expected = Pose(10.0, 5.0, 2.0).inverse() @ world.poses()[0]
    pose = record[-1][0].odometry.pose.pose
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((expected.x_m, expected.y_m, expected.yaw_rad), abs=1e-9)


def test_odometry_does_not_notice_that_a_robot_is_put_elsewhere():
    world, sensors, record = run(team(count=1), steps=10)
    world.set_pose(0, Pose(12.0, 8.0, 1.0))
    world.step([Twist()])
    before, after = record[-1][0].odometry.pose, sensors.read()[0].odometry.pose
    assert math.dist((before.x_m, before.y_m), (after.x_m, after.y_m)) < 0.05


def test_reset_repeats_every_reading():
    world, sensors, record = run(team(), steps=50)
    world.reset()
    sensors.reset()
    assert same(drive(world, sensors, 50), record)


def test_seed_and_nothing_else_decides_the_noise():
    record = run(team(), steps=20)[2]
    assert same(run(team(), steps=20)[2], record)
    assert not same(run(team(), steps=20, seed=2)[2], record)


def test_further_robot_leaves_the_drift_of_others_alone():
    without_laser_noise = Laser(range_max_m=0.5)
    two = run(team(count=2, laser=without_laser_noise), steps=10)[2]
    three = run(team(count=3, laser=without_laser_noise), steps=10)[2]
    assert [readings[1].odometry for readings in two] == [readings[1].odometry for readings in three]


def test_lasers_of_several_kinds_scan_each_as_by_itself_in_the_order_of_robots():
    kinds = (Laser(noise_m=0.0), Laser(beams=7, range_max_m=3.0, noise_m=0.02))
    robots = [
        robot.model_copy(update={"laser": kinds[i]}) for robot, i in zip(team(count=4), (1, 0, 1, 0), strict=True)
    ]
    world, sensors, _ = run(robots, steps=0)
    noise = {i: stream(1, "laser", i) for i in range(4)}
    for _ in range(3):
        world.step([Twist(0.5)] * 4)
        scans = [reading.ranges_m for reading in sensors.read()]
        alone = [LaserBeams(robot.laser, world).scan([i], [noise[i]])[0] for i, robot in enumerate(robots)]
        assert [len(scan) for scan in scans] == [7, 181, 7, 181]
        assert all(np.array_equal(scan, expected) for scan, expected in zip(scans, alone, strict=True))


def test_readings_cannot_be_changed_because_the_record_shares_them():
    _, _, (readings,) = run(team(), steps=1)
    with pytest.raises(ValueError, match="read-only"):
        readings[0].ranges_m[:] = 0.0
    with pytest.raises(TypeError, match="does not support item deletion"):
        del readings[0].sensors["rear"]
    with pytest.raises(ValueError, match="read-only"):
        readings[0].sensors["rear"][:] = 0.0
