"""Robots that lift, carry and drop objects in the world of MuJoCo."""

import math

import numpy as np
import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.mujoco import Gripper
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.simulation import Simulation
from robotteamsim.world.mujoco.world import MujocoWorld
from robotteamsim.world.world import World

SCREEN = Wall(name="screen", start=(2.0, 8.0), end=(4.0, 8.0), thickness_m=0.05)
PLAN = FloorPlan(name="field", bounds=Bounds(max=(20.0, 10.0)), walls=(SCREEN,))
ROBOT = PlacedRobot(start_pose=(3.0, 5.0, 0.0), gripper=Gripper())
CRATE = MovableObject(name="crate", size_m=(0.2, 0.3), height_m=0.2, pose=(3.4, 5.0, 0.0), mass_kg=1.0)


def world_of(*robots, crate=CRATE):
    return MujocoWorld(PLAN, robots or (ROBOT,), Run(), objects=(crate,))


def drive(world, *twists, steps):
    for _ in range(steps):
        world.step(twists)


def height_m(world):
    return world.engine.data.body("box crate").xpos[2]


def test_lifted_object_follows_the_robot_and_falls_when_it_is_dropped():
    world = world_of()
    world.lift_object(0, "crate")
    assert world.loads == {0: "crate"}
    drive(world, Twist(), steps=10)
    assert height_m(world) == pytest.approx(0.05, abs=0.01)
    assert not any(world.in_contact())
    drive(world, Twist(0.5, 0.0, 0.5), steps=40)
    offset = world.poses()[0].inverse() @ world.objects()["crate"]
    assert (offset.x_m, offset.y_m, offset.yaw_rad) == pytest.approx((0.4, 0.0, 0.0), abs=0.03)
    drive(world, Twist(), steps=10)
    there = world.objects()["crate"]
    assert math.dist((there.x_m, there.y_m), (3.4, 5.0)) > 0.5
    world.drop_object(0)
    drive(world, Twist(-0.5), steps=20)
    after = world.objects()["crate"]
    assert height_m(world) == pytest.approx(0.0, abs=0.005)
    assert (after.x_m, after.y_m) == pytest.approx((there.x_m, there.y_m), abs=0.02)
    assert world.loads == {}


def test_heavy_load_tips_a_light_robot_over():
    crate = CRATE.model_copy(update={"mass_kg": 20.0})
    world = world_of(ROBOT.model_copy(update={"gripper": Gripper(max_mass_kg=20.0, lift_m=0.5)}), crate=crate)
    world.lift_object(0, "crate")
    drive(world, Twist(), steps=30)
    assert world.engine.lean_rad()[0] > 0.1


@pytest.mark.parametrize(
    ("robot", "crate", "message"),
    [
        ({"gripper": None}, {}, "robot_0 has no gripper; it needs robots.gripper"),
        ({}, {"pose": (4.0, 5.0, 0.0)}, r"robot_0: box 'crate' is 0.70 m away; expected at most 0.3 m"),
        ({}, {"mass_kg": 6.0}, r"robot_0: box 'crate' has 6 kg; expected at most 5 kg"),
        (
            {"start_pose": (3.0, 7.7, 0.0)},
            {"pose": (3.0, 8.2, 0.0)},
            r"robot_0: box 'crate' is behind wall 'screen'",
        ),
    ],
    ids=["no gripper", "far", "heavy", "behind a wall"],
)
def test_impossible_lift_is_one_line_and_changes_nothing(robot, crate, message):
    world = world_of(ROBOT.model_copy(update=robot), crate=CRATE.model_copy(update=crate))
    with pytest.raises(ValueError, match=f"^{message}$"):
        world.lift_object(0, "crate")
    assert world.loads == {}


def test_only_one_robot_holds_an_object_and_only_known_ones():
    world = world_of(ROBOT, ROBOT.model_copy(update={"start_pose": (3.8, 5.0, 0.0)}))
    world.lift_object(0, "crate")
    with pytest.raises(ValueError, match=r"^robot_0 already holds 'crate'$"):
        world.lift_object(1, "crate")
    with pytest.raises(ValueError, match=r"^unknown object 'keg'; known: crate$"):
        world.lift_object(1, "keg")
    with pytest.raises(ValueError, match=r"^robot_1 holds nothing$"):
        world.drop_object(1)
    with pytest.raises(ValueError, match=r"^robot_id must be in 0\.\.1, got 7$"):
        world.drop_object(7)


@pytest.mark.parametrize(
    "change",
    [
        lambda world: world.set_pose(0, Pose(8.0, 5.0, 0.0)),
        lambda world: world.remove_robot(0),
        lambda world: world.move_object("crate", Pose(8.0, 5.0, 0.0)),
        lambda world: world.remove_object("crate"),
        lambda world: world.reset_positions(),
        lambda world: world.reset(),
    ],
    ids=["robot moved", "robot removed", "object moved", "object removed", "positions reset", "reset"],
)
def test_robot_or_object_that_is_moved_or_removed_ends_the_hold(change):
    world = world_of()
    world.lift_object(0, "crate")
    drive(world, Twist(), steps=5)
    change(world)
    assert world.loads == {}
    drive(world, Twist(0.5), steps=10)
    assert np.isfinite(world.engine.data.qpos).all()


def test_load_survives_another_robot_that_leaves():
    world = world_of(ROBOT.model_copy(update={"start_pose": (8.0, 5.0, 0.0)}), ROBOT)
    world.lift_object(1, "crate")
    drive(world, Twist(), Twist(0.3), steps=10)
    world.remove_robot(0)
    drive(world, Twist(), Twist(0.3), steps=20)
    assert world.loads == {1: "crate"}
    assert world.objects()["crate"].x_m == pytest.approx(world.poses()[1].x_m + 0.4, abs=0.03)


def test_mission_reports_who_lifts_and_drops():
    crate = "[{name: crate, size_m: [0.2, 0.3], pose: [4, 5, 0], mass_kg: 1}]"
    keys = ["run.world=mujoco", "robots.gripper={reach_m: 5}", f"objects={crate}", "robots.start=[3, 5, 0]"]
    simulation = Simulation(load("garage_sar", [*keys, "robots.count=1", "robots.start_poses=[[3, 5, 0]]"]))
    simulation.mission.start()
    events = list(simulation.step().events)
    simulation.lift_object(0, "crate")
    record = simulation.step()
    assert record.loads == {0: "crate"}
    events += record.events
    simulation.drop_object(0)
    events += simulation.step().events
    found = [(event.kind, event.subject, event.robot_id, event.detail) for event in events]
    assert ("object_lifted", "crate", 0, "robot 0 lifts crate") in found
    assert ("object_dropped", "crate", 0, "robot 0 drops crate") in found


def test_plane_has_no_grippers():
    with pytest.raises(ScenarioError, match=r"robots\.gripper: need run\.world mujoco, not box2d$"):
        load("garage_sar", ["robots.gripper={}"])
    with pytest.raises(ValueError, match=r"^robot_0 has no gripper; it needs robots\.gripper and run\.world mujoco$"):
        World(PLAN, [ROBOT], Run(), objects=(CRATE,)).lift_object(0, "crate")
