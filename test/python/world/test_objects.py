"""Boxes and barrels in a world."""

import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation import Simulation
from robotteamsim.world import World

PLAN = FloorPlan(name="floor", bounds=Bounds(min=(-10.0, -10.0), max=(10.0, 10.0)))
ROBOTS = [PlacedRobot(start_pose=(0.0, 0.0, 0.0), laser=Laser(beams=1, angle_min_rad=0.0, angle_max_rad=0.1))]
CRATE = MovableObject(name="crate", size_m=(0.6, 0.4), pose=(2.0, 0.0, 0.0))


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


def test_object_added_to_an_empty_floor_is_pushed():
    world = world_of()
    world.add_object(CRATE)
    for _ in range(40):
        world.step([Twist(0.7)])
    assert world.objects()["crate"].x_m > 2.4
