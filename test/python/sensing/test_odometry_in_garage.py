"""Odometry of robots that drive through the shipped garage, with collisions."""

import math

import numpy as np
import pytest

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import Bounds, FloorPlan, Wall, load
from robotteamsim.scenario.sections import Odometry as OdometryModel
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

EXACT = OdometryModel(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)
MODEL = OdometryModel(alpha1=0.004, alpha2=0.001, alpha3=0.002, alpha4=0.003)
CORRIDOR = FloorPlan(
    name="corridor", bounds=Bounds(max=(40.0, 4.0)), walls=(Wall(name="w", start=(0.0, 3.1), end=(40.0, 3.1)),)
)


def random_twists(count: int, generator: np.random.Generator) -> list[Twist]:
    return [
        Twist(v, 0.0, w)
        for v, w in zip(generator.uniform(-0.7, 0.7, count), generator.normal(0, 1, count), strict=True)
    ]


def test_odometry_without_noise_is_exact_to_a_nanometre_over_five_minutes_of_collisions(scattered_robots):
    plan = load("garage_sar").plan
    generator = np.random.default_rng(31)
    robots = scattered_robots(plan, 20, generator, odometry=EXACT)
    world = World(plan, robots, Run())
    sensors = RobotSensors(world, robots, seed=1)
    touched = set()
    for step in range(3000):
        if step % 30 == 0:
            twists = random_twists(20, generator)
        world.step(twists)
        readings = sensors.read()
        touched |= {robot_id for robot_id, reading in enumerate(readings) if reading.in_contact}
    for robot, pose, reading in zip(robots, world.poses(), readings, strict=True):
        true, believed = Pose(*robot.start_pose).inverse() @ pose, reading.odometry.pose.pose
        assert (believed.x_m, believed.y_m) == pytest.approx((true.x_m, true.y_m), abs=1e-9)
        assert math.remainder(believed.yaw_rad - true.yaw_rad, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert len(touched) >= 10


def test_odometry_of_a_robot_that_slides_along_a_wall_is_its_true_path():
    robots = [PlacedRobot(start_pose=(5.0, 2.8, 0.5), odometry=EXACT)]
    world = World(CORRIDOR, robots, Run())
    sensors = RobotSensors(world, robots, seed=1)
    for _ in range(100):
        world.step([Twist(0.7)])
        reading = sensors.read()[0]
    true = Pose(5.0, 2.8, 0.5) @ reading.odometry.pose.pose
    assert reading.in_contact
    # 0.7 m/s is reached after 0.35 s; the wall leaves the part along it.
    assert true.x_m == pytest.approx(5.0 + math.cos(0.5) * 0.7 * (10.0 - 0.175), abs=0.02)
    assert true.y_m == pytest.approx(2.8, abs=0.005)
    assert reading.odometry.twist.linear_y_mps == pytest.approx(-0.7 * math.cos(0.5) * math.sin(0.5), rel=0.01)


def test_robot_that_is_pushed_sideways_reckons_with_it():
    # The second robot drives at the side of the first, which stands.
    robots = [
        PlacedRobot(start_pose=(10.0, 1.0, math.pi / 2.0), odometry=EXACT),
        PlacedRobot(start_pose=(9.5, 1.0, 0.0), odometry=EXACT),
    ]
    world = World(CORRIDOR, robots, Run())
    sensors = RobotSensors(world, robots, seed=1)
    for _ in range(30):
        world.step([Twist(), Twist(0.7)])
        pushed = sensors.read()[0].odometry
    way_m = world.poses()[0].x_m - 10.0
    assert way_m > 0.1
    assert (pushed.pose.x_m, pushed.pose.y_m) == pytest.approx((0.0, -way_m), abs=1e-9)
    assert pushed.twist.linear_y_mps < -0.01


def test_drifts_of_two_robots_on_the_same_path_are_independent():
    robots = [PlacedRobot(start_pose=(1.0, 0.5 + i, 0.0), odometry=MODEL) for i in range(2)]
    world = World(CORRIDOR, robots, Run())
    sensors = RobotSensors(world, robots, seed=6)
    errors = []
    for _ in range(400):
        world.step([Twist(0.5), Twist(0.5)])
        errors.append([reading.odometry.twist.linear_x_mps - reading.twist.linear_x_mps for reading in sensors.read()])
    assert not any(reading.in_contact for reading in sensors.read())
    assert abs(np.corrcoef(np.array(errors).T)[0, 1]) < 0.2
