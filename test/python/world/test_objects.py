"""Boxes and barrels in a world."""

import math

import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation import Simulation
from robotteamsim.world import World

PLAN = FloorPlan(name="floor", bounds=Bounds(min=(-10.0, -10.0), max=(10.0, 10.0)))
ROBOTS = [PlacedRobot(start_pose=(0.0, 0.0, 0.0), laser=Laser(beams=1, angle_min_rad=0.0, angle_max_rad=0.1))]
CRATE = MovableObject(name="crate", size_m=(0.6, 0.4), pose=(2.0, 0.0, 0.0))
DRUM = MovableObject(name="drum", kind="barrel", radius_m=0.3, pose=(0.0, 2.0, 0.0))


def world_of(*objects: MovableObject) -> World:
    return World(PLAN, ROBOTS, Run(), objects=objects)


@pytest.mark.parametrize(
    "obj", [CRATE, MovableObject(name="drum", kind="barrel", radius_m=0.3, pose=(2.0, 0.0, 0.0))], ids=["box", "barrel"]
)
def test_lasers_see_objects_where_they_are(obj):
    world = world_of(obj)
    sensors = RobotSensors(world, ROBOTS, 1)
    assert sensors.read()[0].ranges_m[0] == pytest.approx(1.6, abs=1e-6)
    for _ in range(40):
        world.step([Twist(0.7)])
    assert sensors.read()[0].ranges_m[0] == pytest.approx(0.1, abs=0.01)


def test_robot_is_not_put_into_an_object():
    world = world_of(CRATE)
    world.set_pose(0, Pose(2.0, 0.4, 0.0))
    with pytest.raises(PlacementError, match=r"^robot_0: pose \(2\.00, 0\.30\) is inside box 'crate'$"):
        world.set_pose(0, Pose(2.0, 0.3, 0.0))


def test_object_where_a_robot_starts_is_rejected():
    obj = MovableObject(name="crate", size_m=(0.6, 0.4), pose=(0.4, 0.0, 0.0))
    with pytest.raises(
        PlacementError, match=r"^objects\.0\.pose: \[0\.4, 0\]: box 'crate' overlaps robot 0 at its start pose$"
    ):
        world_of(obj)


def test_objects_of_a_scenario_are_in_its_simulation():
    obj = "{name: crate, size_m: [0.4, 0.4], pose: [4.0, 3.0, 0.0]}"
    scenario = load("tutorial_arena", [f"objects=[{obj}]"])
    assert Simulation(scenario).world.objects() == {"crate": Pose(4.0, 3.0, 0.0)}


def test_objects_are_added_moved_and_removed_while_the_world_runs():
    world = world_of(CRATE)
    sensors = RobotSensors(world, ROBOTS, 1)
    world.add_object(DRUM)
    assert list(world.objects()) == ["crate", "drum"]
    world.move_object("drum", Pose(1.0, 0.0, 0.0))
    assert sensors.read()[0].ranges_m[0] == pytest.approx(0.6, abs=1e-6)
    world.step([Twist()])
    assert world.objects()["drum"] == Pose(1.0, 0.0, 0.0)
    world.remove_object("drum")
    assert sensors.read()[0].ranges_m[0] == pytest.approx(1.6, abs=1e-6)
    world.remove_object("crate")
    assert world.objects() == {}
    for _ in range(40):
        world.step([Twist(0.7)])
    assert world.poses()[0].x_m > 2.4


def test_object_added_to_an_empty_floor_is_pushed():
    world = world_of()
    world.add_object(CRATE)
    for _ in range(40):
        world.step([Twist(0.7)])
    assert world.objects()["crate"].x_m > 2.4


def test_reset_brings_back_the_objects_of_the_scenario_and_the_rerun_is_equal_to_the_bit():
    world = world_of(CRATE)

    def run() -> list[bytes]:
        rows = []
        for index in range(60):
            if index == 20:
                world.add_object(DRUM.model_copy(update={"pose": (2.5, 0.5, 0.0)}))
            if index == 40:
                world.remove_object("crate")
            world.step([Twist(0.7, 0.0, 0.05)])
            rows.append(world.core.poses().tobytes() + world.core.object_poses().tobytes())
        return rows

    first = run()
    world.reset()
    assert world.objects() == {"crate": Pose(2.0, 0.0, 0.0)}
    assert run() == first


def test_overlapping_object_is_rejected_with_the_name_of_the_other():
    wall = Wall(name="south", start=(-5.0, -5.0), end=(5.0, -5.0))
    door = Door(name="gate", start=(5.0, -5.0), end=(6.0, -5.0), motion="swing")
    plan = PLAN.model_copy(update={"walls": (wall,), "doors": (door,)})
    world = World(plan, ROBOTS, Run(), objects=(CRATE, DRUM))
    for place, hit in (
        ((-3.0, -4.8), "wall 'south'"),
        ((5.1, -4.5), "door 'gate'"),
        ((0.1, 1.7), "barrel 'drum'"),
        ((0.3, 0.3), "robot_0"),
        ((11.0, 0.0), "outside the plan"),
    ):
        text = rf"^box 'crate': pose \({place[0]:.2f}, {place[1]:.2f}\) is (inside )?{hit}"
        with pytest.raises(PlacementError, match=text):
            world.move_object("crate", Pose(*place, 0.0))
        with pytest.raises(PlacementError, match=text.replace("crate", "other")):
            world.add_object(CRATE.model_copy(update={"name": "other", "pose": (*place, 0.0)}))
    with pytest.raises(ValueError, match=r"^unknown object 'crat'; known: crate, drum$"):
        world.remove_object("crat")
    with pytest.raises(ValueError, match=r"^there is already a box 'crate'$"):
        world.add_object(CRATE)
    with pytest.raises(ValueError, match=r"^box 'crate': pose must be finite"):
        world.move_object("crate", Pose(math.nan, 0.0, 0.0))
    assert world.objects() == {"crate": Pose(2.0, 0.0, 0.0), "drum": Pose(0.0, 2.0, 0.0)}
