"""Omnidirectional and car-like robots in a world."""

import math

import pytest

from robotteamsim.geometry import Twist
from robotteamsim.scenario.drives import AnyDrive, CarDrive, OmniDrive
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.sections import Odometry, PlacedRobot, Run
from robotteamsim.world import World

RUN = Run()
OMNI = OmniDrive(kind="omni")
CAR = CarDrive(kind="car", wheelbase_m=0.4, max_steering_rad=0.6)
PLAN = FloorPlan(
    name="wall ahead",
    bounds=Bounds(min=(-20.0, -20.0), max=(20.0, 20.0)),
    walls=(Wall(name="wall", start=(5.1, -20.0), end=(5.1, 20.0)),),
)
EXACT = Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)


def world_of(drive: AnyDrive, pose: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[World, list[PlacedRobot]]:
    robots = [PlacedRobot(start_pose=pose, drive=drive, odometry=EXACT)]
    return World(PLAN, robots, RUN), robots


def step(world: World, twist: Twist, steps: int) -> None:
    for _ in range(steps):
        world.step([twist])


def test_omni_robot_stops_sideways_at_a_wall_and_leaves_it_at_once():
    world, _ = world_of(OMNI, (4.0, 0.0, math.pi / 2))
    step(world, Twist(0.0, -0.7, 0.0), 40)
    assert world.poses()[0].x_m == pytest.approx(4.8, abs=0.005)
    assert world.in_contact() == [True]
    assert world.twists()[0].linear_y_mps == pytest.approx(0.0, abs=1e-6)
    step(world, Twist(0.0, 0.7, 0.0), 1)
    assert world.twists()[0].linear_y_mps > 0.05


def test_car_that_a_wall_stops_does_not_turn():
    world, _ = world_of(CAR, (4.0, 0.0, 0.0))
    step(world, Twist(0.7, 0.0, 0.0), 30)
    yaw_rad = world.poses()[0].yaw_rad
    step(world, Twist(0.7, 0.0, 2.0), 20)
    assert world.poses()[0].yaw_rad == pytest.approx(yaw_rad, abs=1e-3)


def test_greatest_turn_of_a_car_follows_from_its_steering():
    assert CAR.max_turn_radps == pytest.approx(0.7 * math.tan(0.6) / 0.4)
