"""Boxes and barrels in a world."""

import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run
from robotteamsim.scenario.things import Thing
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation import Simulation
from robotteamsim.world import World

PLAN = FloorPlan(name="floor", bounds=Bounds(min=(-10.0, -10.0), max=(10.0, 10.0)))
ROBOTS = [PlacedRobot(start_pose=(0.0, 0.0, 0.0), laser=Laser(beams=1, angle_min_rad=0.0, angle_max_rad=0.1))]
CRATE = Thing(name="crate", size_m=(0.6, 0.4), pose=(2.0, 0.0, 0.0))
DRUM = Thing(name="drum", kind="barrel", radius_m=0.3, pose=(0.0, 2.0, 0.0))


def world_of(*things: Thing) -> World:
    return World(PLAN, ROBOTS, Run(), things=things)


def test_things_are_pushed_and_put_back_by_a_reset():
    world = world_of(CRATE, DRUM)
    for _ in range(40):
        world.step([Twist(0.7)])
    assert world.things()["crate"].x_m > 2.4
    assert world.things()["drum"] == Pose(0.0, 2.0, 0.0)
    world.reset_positions()
    assert world.things()["crate"].x_m > 2.4
    world.reset()
    assert world.things() == {"crate": Pose(2.0, 0.0, 0.0), "drum": Pose(0.0, 2.0, 0.0)}


@pytest.mark.parametrize(
    "thing", [CRATE, Thing(name="drum", kind="barrel", radius_m=0.3, pose=(2.0, 0.0, 0.0))], ids=["box", "barrel"]
)
def test_lasers_see_things_where_they_are(thing):
    world = world_of(thing)
    sensors = RobotSensors(world, ROBOTS, 1)
    assert sensors.read()[0].ranges_m[0] == pytest.approx(1.6, abs=1e-6)
    for _ in range(40):
        world.step([Twist(0.7)])
    assert sensors.read()[0].ranges_m[0] == pytest.approx(0.1, abs=0.01)


def test_robot_is_not_put_into_a_thing():
    world = world_of(CRATE)
    world.set_pose(0, Pose(2.0, 0.4, 0.0))
    with pytest.raises(PlacementError, match=r"^robot_0: pose \(2\.00, 0\.30\) is inside box 'crate'$"):
        world.set_pose(0, Pose(2.0, 0.3, 0.0))


def test_thing_where_a_robot_starts_is_refused():
    thing = Thing(name="crate", size_m=(0.6, 0.4), pose=(0.4, 0.0, 0.0))
    with pytest.raises(
        PlacementError, match=r"^things\.0\.pose: \[0\.4, 0\]: box 'crate' stands where robot 0 starts$"
    ):
        world_of(thing)


def test_things_of_a_scenario_stand_in_its_simulation():
    thing = "{name: crate, size_m: [0.4, 0.4], pose: [4.0, 3.0, 0.0]}"
    scenario = load("tutorial_arena", [f"things=[{thing}]"])
    assert Simulation(scenario).world.things() == {"crate": Pose(4.0, 3.0, 0.0)}
