"""Ramps and platforms in the world of MuJoCo."""

import math

import numpy as np
import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.drives import CarDrive, OmniDrive
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.mujoco import Mujoco, Ramp
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world.mujoco.world import MujocoWorld

PLAN = FloorPlan(name="field", bounds=Bounds(max=(20.0, 10.0)))
SLOPE = Ramp(start=(4.0, 5.0), end=(7.0, 5.0), width_m=2.0, height_m=0.45)
PLATFORM = Ramp(start=(7.0, 5.0), end=(10.0, 5.0), width_m=2.0, height_m=0.45, from_height_m=0.45)
SLOPE_RAD = math.atan2(0.45, 3.0)


def world_of(*robots, objects=()):
    return MujocoWorld(PLAN, robots, Run(mujoco=Mujoco(ramps=(SLOPE, PLATFORM))), objects=objects)


def height_m(world, robot_id=0):
    return world.engine.data.xpos[world.engine.body_id(robot_id)][2]


CAR = {
    "drive": CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.6),
    "footprint_m": ((-0.08, -0.15), (0.4, -0.15), (0.4, 0.15), (-0.08, 0.15)),
}


@pytest.mark.parametrize("form", [{}, {"drive": OmniDrive(kind="omni")}, CAR], ids=["differential", "omni", "car"])
def test_robot_drives_up_a_ramp_onto_a_platform(form):
    world = world_of(PlacedRobot(start_pose=(3.0, 5.0, 0.0), **form))
    on_slope = []
    for _ in range(150):
        x_m = world.poses()[0].x_m
        if 5.0 < x_m < 6.0:
            on_slope.append((height_m(world) - SLOPE.top_m((x_m, 5.0)), world.engine.lean_rad()[0] - SLOPE_RAD))
        world.step([Twist(0.5) if x_m < 8.5 else Twist()])
    assert len(on_slope) > 10
    assert np.abs(on_slope).max() < 0.03
    assert world.poses()[0].x_m == pytest.approx(8.6, abs=0.15)
    assert (height_m(world), world.engine.lean_rad()[0]) == pytest.approx((0.45, 0.0), abs=0.01)
    assert world.mishaps == {}


def test_side_of_a_ramp_is_a_wall_that_robots_touch_and_lasers_see():
    low = Laser(beams=1, angle_min_rad=0.0, angle_max_rad=0.1, forward_m=0.0, height_m=0.1, range_max_m=9.0)
    robot = PlacedRobot(start_pose=(9.0, 2.0, 0.5 * math.pi), laser=low)
    world = world_of(robot)
    assert RobotSensors(world, [robot], 1).read()[0].ranges_m[0] == pytest.approx(2.0, abs=0.01)
    for _ in range(60):
        world.step([Twist(0.5)])
    assert world.poses()[0].y_m == pytest.approx(3.8, abs=0.02)
    assert world.in_contact() == [True]


def test_robots_and_objects_are_placed_on_top():
    crate = MovableObject(name="crate", size_m=(0.4, 0.4), pose=(9.0, 5.5, 0.0))
    world = world_of(PlacedRobot(start_pose=(8.0, 5.0, 0.0)), PlacedRobot(start_pose=(2.0, 5.0, 0.0)), objects=(crate,))
    world.set_pose(1, Pose(5.5, 5.0, math.pi))
    for _ in range(10):
        world.step(np.zeros((2, 3)))
    assert height_m(world, 0) == pytest.approx(0.45, abs=0.01)
    assert height_m(world, 1) == pytest.approx(0.225, abs=0.02)
    assert world.engine.data.body("box crate").xpos[2] == pytest.approx(0.45, abs=0.01)
    assert world.objects()["crate"].x_m == pytest.approx(9.0, abs=1e-3)


def test_ramp_that_is_too_steep_for_the_tyres_is_not_climbed():
    steep = Ramp(start=(4.0, 5.0), end=(5.0, 5.0), width_m=2.0, height_m=1.2)
    robot = PlacedRobot(start_pose=(3.0, 5.0, 0.0))
    world = MujocoWorld(PLAN, [robot], Run(mujoco=Mujoco(ramps=(steep,))))
    for _ in range(60):
        world.step([Twist(0.5)])
    assert world.poses()[0].x_m < 4.2


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (["run.mujoco.ramps=[{from: [4, 5], to: [7, 5], height_m: 0.4}]"], "run.mujoco.ramps: need run.world mujoco"),
        (
            ["run.world=mujoco", "run.mujoco.ramps=[{from: [4, 5], to: [700, 5], height_m: 0.4}]"],
            r"run.mujoco.ramps.0.to: \[700, 5\] lies outside the bounds",
        ),
        (
            ["run.world=mujoco", "run.mujoco.ramps=[{from: [4, 5], to: [4, 5], height_m: 0.4}]"],
            "run.mujoco.ramps.0.to: is 0 m from 'from'; expected at least 0.1",
        ),
        (
            ["run.world=mujoco", "run.mujoco.ramps=[{from: [4, 5], to: [7, 5]}]"],
            "run.mujoco.ramps.0.height_m: missing",
        ),
        (
            ["run.world=mujoco", "run.mujoco.ramps=[{from: [4, 5], to: [7, 5], height_m: 1e-9}]"],
            "run.mujoco.ramps.0.height_m: .*0.001",
        ),
    ],
    ids=["box2d", "outside", "short", "no height", "flat"],
)
def test_invalid_ramp_is_one_line(keys, message):
    with pytest.raises(ScenarioError, match=message):
        load("garage_sar", keys)
