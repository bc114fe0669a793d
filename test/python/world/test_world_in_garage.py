"""Robots that drive at random through the shipped garage for long."""

import math
import subprocess
import sys

import numpy as np
import pytest
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Twist
from robotteamsim.scenario import FloorPlan, load
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Drive, PlacedRobot, Run
from robotteamsim.world import World

pytestmark = pytest.mark.slow

FASTEST = Drive(max_speed_mps=10.0, max_turn_radps=20.0, max_acceleration_mps2=50.0, max_turn_acceleration_radps2=200.0)


@pytest.fixture(scope="module")
def garage() -> FloorPlan:
    return load("garage_sar").plan


def full_speed(drive: Drive, count: int, generator: np.random.Generator) -> list[Twist]:
    speeds_mps = drive.max_speed_mps * generator.choice([-1.0, 1.0, 1.0], count)
    turns_radps = 0.3 * drive.max_turn_radps * generator.uniform(-1.0, 1.0, count)
    return [Twist(v, 0.0, w) for v, w in zip(speeds_mps.tolist(), turns_radps.tolist(), strict=True)]


@pytest.mark.parametrize(
    ("drive", "radius_m", "run", "steps", "depth_m"),
    [
        (Drive(), 0.2, Run(), 4000, 0.01),
        (FASTEST, 0.2, Run(), 2000, 0.015),
        (FASTEST, 0.05, Run(step_s=0.2, physics_substeps=1), 500, 0.015),
    ],
    ids=["default drive", "10 m/s", "10 m/s, small, one substep"],
)
def test_no_robot_overlaps_a_solid_or_a_robot_by_more_than_about_a_centimetre(
    garage, scattered_robots, drive, radius_m, run, steps, depth_m
):
    generator = np.random.default_rng(5)
    robots = scattered_robots(garage, 12, generator, drive=drive, radius_m=radius_m)
    world, solid = World(garage, robots, run), obstacles(garage)
    to_others = np.where(np.eye(12, dtype=bool), math.inf, 0.0)
    touched = set()
    for step in range(steps):
        if step % 20 == 0:
            twists = full_speed(drive, 12, generator)
        world.step(twists)
        positions_m = world.positions_m()
        to_solids_m = shapely.distance(solid, shapely.points(positions_m))
        to_others_m = to_others + np.hypot(*(positions_m[:, None] - positions_m).transpose(2, 0, 1))
        assert to_solids_m.min() >= radius_m - depth_m, f"step {step}"
        assert to_others_m.min() >= 2.0 * radius_m - depth_m, f"step {step}"
        touched |= {robot_id for robot_id, touches in enumerate(world.in_contact()) if touches}
    assert len(touched) == 12


def test_no_motion_between_two_steps_crosses_a_wall(garage, scattered_robots):
    generator = np.random.default_rng(6)
    world = World(garage, scattered_robots(garage, 12, generator, drive=FASTEST), Run())
    # Half the thinnest wall, so that a way around a corner may cut it by a little.
    solid = shapely.buffer(obstacles(garage), -0.05, join_style="mitre")
    for step in range(2000):
        if step % 20 == 0:
            twists = full_speed(FASTEST, 12, generator)
        before_m = world.positions_m()
        world.step(twists)
        ways = shapely.linestrings(np.stack([before_m, world.positions_m()], axis=1))
        assert not shapely.intersects(solid, ways).any(), f"step {step}"


def test_speeds_and_accelerations_stay_within_the_drive_for_any_commands(garage, scattered_robots):
    generator = np.random.default_rng(7)
    run, drive = Run(), Drive()
    world = World(garage, scattered_robots(garage, 10, generator), run)
    most_mps, most_radps = drive.max_acceleration_mps2 * run.step_s, drive.max_turn_acceleration_radps2 * run.step_s
    twists, free = world.twists(), [True] * 10
    for _ in range(1000):
        last, was_free = twists, free
        world.step([Twist(*row) for row in generator.normal(0.0, 5.0, (10, 3)).tolist()])
        twists, free = world.twists(), [not touches for touches in world.in_contact()]
        for now, before, unhindered in zip(twists, last, np.logical_and(free, was_free), strict=True):
            assert abs(now.angular_z_radps) <= drive.max_turn_radps + 1e-12
            assert abs(now.angular_z_radps - before.angular_z_radps) <= most_radps + 1e-12
            if unhindered:
                assert now.linear_y_mps == 0.0
                assert abs(now.linear_x_mps) <= drive.max_speed_mps + 1e-12
                assert abs(now.linear_x_mps - before.linear_x_mps) <= most_mps + 1e-12


def test_robot_that_starts_in_a_closed_door_of_the_plan_is_rejected(garage):
    with pytest.raises(PlacementError) as error:
        World(garage, [PlacedRobot(start_pose=(54.4, 37.5, 0.0))], Run())
    expected = "robot_0: start pose (54.40, 37.50) is inside door 'stair_door'; expected 0.2 m of clearance"
    assert str(error.value) == expected


DRIVE_AND_PRINT = """
import sys
import numpy as np
from robotteamsim.geometry import Twist
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.world import World

scenario = load("garage_sar", ["robots.count=12", "robots.spacing_m=0.41"])
world = World(scenario.plan, resolve(scenario).robots, scenario.run)
generator = np.random.default_rng(8)
for _ in range(40):
    twists = [Twist(v, 0.0, w) for v, w in generator.uniform(-1.0, 1.0, (12, 2)).tolist()]
    for _ in range(10):
        world.step(twists)
assert sum(world.in_contact()) > 0
poses = np.array([(pose.x_m, pose.y_m, pose.yaw_rad) for pose in world.poses()])
sys.stdout.write(poses.tobytes().hex())
"""


def test_two_processes_compute_the_same_bits():
    first, second = (
        subprocess.run([sys.executable, "-c", DRIVE_AND_PRINT], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    assert len(first) == 12 * 3 * 16
    assert first == second
