"""Doors whose leaves swing or slide."""

import math

import pytest

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import leaf_corners, solids
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World
from robotteamsim.world.doors import DoorState

WALLS = (
    Wall(name="south", start=(5.0, 0.0), end=(5.0, 2.0), thickness_m=0.1),
    Wall(name="north", start=(5.0, 3.0), end=(5.0, 6.0), thickness_m=0.1),
)
BEAM = Laser(beams=1, angle_min_rad=0.0, angle_max_rad=0.1)


def door(**keys) -> Door:
    return Door(name="gate", start=(5.0, 2.0), end=(5.0, 3.0), **keys)


def plan(gate: Door) -> FloorPlan:
    return FloorPlan(name="two rooms", bounds=Bounds(max=(10.0, 6.0)), walls=WALLS, doors=(gate,))


def world_of(gate: Door, *poses: tuple[float, float, float], objects: tuple[MovableObject, ...] = ()) -> World:
    robots = [PlacedRobot(start_pose=pose, laser=BEAM) for pose in poses or [(1.0, 1.0, 0.0)]]
    return World(plan(gate), robots, Run(), objects=objects)


def step(world: World, steps: int, *twists: Twist) -> list[DoorState]:
    states = []
    for _ in range(steps):
        world.step(twists or [Twist()] * world.num_robots)
        states.append(world.door_states()["gate"])
    return states


@pytest.mark.parametrize(
    ("keys", "tip"),
    [
        ({"motion": "swing"}, (4.0, 2.0)),
        ({"motion": "swing", "angle_rad": -0.5 * math.pi}, (6.0, 2.0)),
        ({"motion": "slide"}, (5.0, 2.0)),
    ],
    ids=["left", "right", "slide"],
)
def test_open_leaf_is_where_it_has_swung_or_slid_to(keys, tip):
    corners = leaf_corners(door(**keys), 1.0)
    assert sum(x for x, _ in corners[1:3]) / 2.0 == pytest.approx(tip[0])
    assert sum(y for _, y in corners[1:3]) / 2.0 == pytest.approx(tip[1])
    assert [solid.corners for solid in solids(plan(door(**keys))) if solid.kind == "door"] == [corners]


def test_beams_see_the_leaf_where_it_is():
    world = world_of(door(motion="swing", closed=True), (3.0, 2.5, 0.0))
    # The laser stands 0.1 m before the robot's middle.
    sensors = RobotSensors(world, [PlacedRobot(start_pose=(3.0, 2.5, 0.0), laser=BEAM)], 1)
    assert sensors.read()[0].ranges_m[0] == pytest.approx(1.87)
    world.set_door("gate", False)
    step(world, 5)
    # The leaf has turned by pi / 8: its middle line meets y = 2.5 at x = 5 - 0.5 tan(pi/8).
    expected = 1.9 - 0.5 * math.tan(math.pi / 8.0) - 0.03 / math.cos(math.pi / 8.0)
    assert sensors.read()[0].ranges_m[0] == pytest.approx(expected, abs=1e-6)


def test_leaf_waits_for_a_robot_and_for_an_object_and_goes_on_when_they_are_gone():
    box = MovableObject(name="box", size_m=(0.3, 0.3), pose=(4.7, 2.8, 0.0))
    world = world_of(door(motion="swing"), (4.45, 2.35, 0.0), objects=(box,))
    world.set_door("gate", True)
    assert step(world, 30)[-1].motion == "held"
    assert (world.poses()[0], world.objects()["box"]) == (Pose(4.45, 2.35, 0.0), Pose(4.7, 2.8, 0.0))
    world.set_pose(0, Pose(2.0, 2.0, 0.0))
    held = step(world, 30)[-1]
    assert (held.motion, held.closed) == ("held", False)
    assert world.objects()["box"] == Pose(4.7, 2.8, 0.0)


def test_robots_are_not_put_into_a_leaf_wherever_it_is():
    world = world_of(door(motion="swing", closed=True))
    world.set_pose(0, Pose(4.5, 2.0, 0.0))
    world.set_pose(0, Pose(1.0, 1.0, 0.0))
    world.set_door("gate", False)
    step(world, 20)
    with pytest.raises(PlacementError, match=r"^robot_0: pose \(4\.50, 2\.10\) is inside door 'gate'"):
        world.set_pose(0, Pose(4.5, 2.1, 0.0))
    world.set_pose(0, Pose(5.0, 2.6, 0.0))


def test_robot_that_starts_in_an_open_leaf_is_rejected():
    with pytest.raises(PlacementError, match=r"^robot_0: start pose \(4\.50, 2\.10\) is inside door 'gate'"):
        world_of(door(motion="swing"), (4.5, 2.1, 0.0))


def test_reset_puts_the_leaf_back_and_the_rerun_is_equal_to_the_bit():
    world = world_of(door(motion="swing", closed=True), (4.0, 2.5, 0.0), (4.0, 3.5, -0.5))

    def run() -> list[object]:
        rows: list[object] = []
        for index in range(80):
            if index in (3, 30):
                world.set_door("gate", index == 30)
            world.step([Twist(0.7, 0.0, 0.1), Twist(0.5, 0.0, -0.1)])
            rows.append((world.core.poses().tobytes(), world.door_states()["gate"]))
        return rows

    first = run()
    assert "held" in {state.motion for _, state in first}
    world.reset()
    assert world.door_states() == {"gate": DoorState(closed=True, opening=0.0)}
    assert run() == first
