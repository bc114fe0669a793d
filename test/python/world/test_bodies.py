"""Robots whose bodies have corners."""

import math

import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run, Team
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

PLAN = FloorPlan(
    name="wall ahead",
    bounds=Bounds(min=(-10.0, -10.0), max=(10.0, 10.0)),
    walls=(Wall(name="wall", start=(5.1, -10.0), end=(5.1, 10.0)),),
)
LONG = ((-0.3, -0.2), (0.7, -0.2), (0.7, 0.2), (-0.3, 0.2))
"""A car's body: base_link at the rear axle."""


def robot_at(x_m: float, y_m: float, yaw_rad: float = 0.0, **more: object) -> PlacedRobot:
    return PlacedRobot(start_pose=(x_m, y_m, yaw_rad), footprint_m=LONG, **more)


def test_robot_stops_with_its_nose_at_the_wall():
    world = World(PLAN, [robot_at(3.0, 0.0)], Run())
    for _ in range(40):
        world.step([Twist(0.7)])
    assert world.poses()[0].x_m == pytest.approx(4.3, abs=0.005)
    assert world.in_contact() == [True]


def test_corners_may_be_clockwise_or_counter_clockwise():
    there, back = (PlacedRobot(start_pose=(0.0, 0.0, 0.0), footprint_m=ring) for ring in (LONG, LONG[::-1]))
    assert set(there.corners_m) == set(back.corners_m)
    worlds = [World(PLAN, [robot], Run()) for robot in (there, back)]
    for world in worlds:
        for _ in range(60):
            world.step([Twist(0.7, 0.0, 0.1)])
    assert worlds[0].poses()[0].x_m == pytest.approx(worlds[1].poses()[0].x_m, abs=1e-3)


def test_lasers_see_the_corners_of_others():
    watcher = PlacedRobot(start_pose=(0.0, 0.0, 0.0), laser=Laser(beams=3, forward_m=0.0))
    robots = [watcher, robot_at(3.0, 0.0)]
    readings = RobotSensors(World(PLAN, robots, Run()), robots, 1).read()
    assert readings[0].ranges_m[1] == pytest.approx(2.7, abs=1e-6)


def test_robots_side_by_side_may_be_nearer_than_their_length():
    World(PLAN, [robot_at(0.0, 0.0), robot_at(0.0, 0.4)], Run())
    with pytest.raises(PlacementError, match=r"^robot_1: start pose \(0\.00, 0\.39\) is inside robot_0 at \(0\.00, 0"):
        World(PLAN, [robot_at(0.0, 0.0), robot_at(0.0, 0.39)], Run())


def test_robot_may_start_along_a_wall_but_not_across_it():
    world = World(PLAN, [robot_at(0.0, 0.0)], Run())
    world.set_pose(0, Pose(4.8, 0.0, math.pi / 2))
    with pytest.raises(PlacementError, match=r"^robot_0: pose \(4\.80, 0\.00\) is inside wall 'wall'$"):
        world.set_pose(0, Pose(4.8, 0.0, 0.0))


def test_robot_reaches_as_far_as_its_farthest_corner():
    assert robot_at(0.0, 0.0).reach_m == pytest.approx(math.hypot(0.7, 0.2))
    assert PlacedRobot(start_pose=(0.0, 0.0, 0.0), radius_m=0.3).reach_m == 0.3


def test_team_with_corners_keeps_apart_by_its_reach():
    with pytest.raises(ValueError, match=r"0\.8 is below two radii, 1\.45602"):
        Team(start=(0.0, 0.0, 0.0), footprint_m=LONG)
