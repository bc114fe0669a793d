"""Where robots touch what they run into."""

import math

import numpy as np
import pytest
import shapely

from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import Bounds, FloorPlan, Wall, load
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.world import World

CORNER = FloorPlan(
    name="corner",
    bounds=Bounds(max=(10.0, 8.0)),
    walls=(Wall(name="east", start=(5.1, 0.0), end=(5.1, 5.0)), Wall(name="north", start=(0.0, 5.1), end=(5.2, 5.1))),
)


def world_of(*poses: tuple[float, float, float], plan: FloorPlan = CORNER) -> World:
    return World(plan, [PlacedRobot(start_pose=pose) for pose in poses], Run(physics_substeps=1))


def press(world: World, *twists: Twist, steps: int = 30) -> dict[int, tuple[float, ...]]:
    for _ in range(steps):
        world.step(twists)
    return world.contact_angles_rad()


def first_contact(world: World, twist: Twist) -> dict[int, tuple[float, ...]]:
    for _ in range(100):
        world.step([twist])
        if world.contact_angles_rad():
            break
    return world.contact_angles_rad()


@pytest.mark.parametrize("yaw_rad", [0.0, 0.7, -1.1])
def test_wall_is_touched_in_its_direction(yaw_rad):
    world = world_of((4.6, 2.5, yaw_rad))
    assert press(world, Twist(0.5)) == {0: (pytest.approx(-yaw_rad, abs=1e-3),)}


def test_wall_behind_is_touched_once():
    world = world_of((4.6, 2.5, math.pi))
    ((angle_rad,),) = press(world, Twist(-0.5)).values()
    assert abs(angle_rad) == pytest.approx(math.pi, abs=1e-3)


def test_corner_is_touched_on_both_sides_in_ascending_order():
    world = world_of((4.6, 4.6, math.pi / 4.0))
    assert press(world, Twist(0.5)) == {0: pytest.approx((-math.pi / 4.0, math.pi / 4.0), abs=1e-2)}


def test_robots_touch_each_other_from_opposite_sides():
    world = world_of((2.0, 2.0, 0.0), (2.5, 2.2, 0.0))
    angles_rad = press(world, Twist(0.5), Twist(-0.1), steps=8)
    (ax, ay), (bx, by) = world.positions_m()
    towards_rad = math.atan2(by - ay, bx - ax)
    assert angles_rad[0] == (pytest.approx(towards_rad, abs=0.02),)
    assert angles_rad[1] == (pytest.approx(towards_rad - math.pi, abs=0.02),)


def test_robot_that_turns_on_the_spot_at_a_wall_feels_it_go_round():
    world = world_of((4.6, 2.5, 0.0))
    before = press(world, Twist(0.5))[0][0]
    after = press(world, Twist(0.05, 0.0, 0.5), steps=10)[0][0]
    assert before - after == pytest.approx(world.poses()[0].yaw_rad, abs=1e-3)
    assert before - after > 0.3


def test_free_robot_and_robot_after_a_reset_touch_nothing():
    world = world_of((4.6, 2.5, 0.0), (2.0, 2.0, 0.0))
    assert list(press(world, Twist(0.5), Twist())) == [0]
    assert press(world, Twist(-0.5), Twist(), steps=5) == {}
    press(world, Twist(0.5), Twist())
    world.reset()
    assert world.contact_angles_rad() == {}


def test_body_with_corners_feels_the_side_or_the_corner_that_touches():
    sides = ((0.3, -0.2), (0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2))
    robot = PlacedRobot(start_pose=(4.4, 2.5, 0.0), footprint_m=sides)
    world = World(CORNER, [robot], Run(physics_substeps=1))
    assert press(world, Twist(0.5)) == {0: (pytest.approx(0.0, abs=0.03),)}
    turned = PlacedRobot(start_pose=(4.4, 2.5, 0.4), footprint_m=sides)
    world = World(CORNER, [turned], Run(physics_substeps=1))
    ((angle_rad,),) = first_contact(world, Twist(0.3)).values()
    assert angle_rad == pytest.approx(math.atan2(-0.2, 0.3), abs=0.02)


@pytest.mark.slow
def test_every_contact_in_the_garage_points_at_something_and_misses_nothing(scattered_robots):
    plan = load("garage_sar").plan
    generator = np.random.default_rng(8)
    robots = scattered_robots(plan, 40, generator)
    world = World(plan, robots, Run(physics_substeps=1, step_s=0.02))
    pieces = shapely.get_parts(obstacles(plan))
    contacts = 0
    for step in range(1000):
        if step % 100 == 0:
            twists = np.column_stack([generator.uniform(-0.7, 0.7, 40), np.zeros(40), generator.normal(0.0, 1.0, 40)])
        world.step(twists)
        if step % 10:
            continue
        poses = world.poses()
        discs = [shapely.Point(pose.x_m, pose.y_m).buffer(0.2, quad_segs=64) for pose in poses]
        for robot_id, angles_rad in world.contact_angles_rad().items():
            pose, middle = poses[robot_id], shapely.Point(poses[robot_id].x_m, poses[robot_id].y_m)
            others = np.array([*discs[:robot_id], *discs[robot_id + 1 :], *pieces])
            for angle_rad in angles_rad:
                rim = pose @ Pose(0.2 * math.cos(angle_rad), 0.2 * math.sin(angle_rad), 0.0)
                assert shapely.distance(others, shapely.Point(rim.x_m, rim.y_m)).min() < 0.008
            nearest = others[np.argmin(shapely.distance(others, middle))]
            seen = pose.inverse() @ Pose(*shapely.shortest_line(middle, nearest).coords[1], 0.0)
            off_rad = [math.remainder(math.atan2(seen.y_m, seen.x_m) - angle_rad, math.tau) for angle_rad in angles_rad]
            assert np.abs(off_rad).min() < 0.06
            contacts += len(angles_rad)
    assert contacts > 100
