"""Every world: doors and objects."""

import math

import pytest
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import door_corners
from robotteamsim.world.doors import DoorState

FORWARD, STOP = Twist(0.5), Twist()
BOX = MovableObject(name="box", size_m=(0.4, 0.4), pose=(3.0, 2.0, 0.0), mass_kg=1.0, friction=0.4)
BARREL = MovableObject(name="drum", kind="barrel", radius_m=0.3, pose=(3.0, 2.0, 0.0), mass_kg=1.5, friction=0.3)


def drive(world, *twists, steps):
    states = []
    for _ in range(steps):
        world.step(twists or [STOP] * world.num_robots)
        states.append(world.door_states()["gate"])
    return states


def test_instant_door_stops_robots_only_while_it_is_closed(world_of):
    world = world_of((5.0, 3.0, 0.0), door={"closed": True})
    drive(world, FORWARD, steps=30)
    assert world.poses()[0].x_m == pytest.approx(5.77, abs=0.01)
    version = world.door_states().version
    world.set_door("gate", closed=False)
    assert world.door_states()["gate"] == DoorState(closed=False, opening=1.0)
    assert world.door_states().version > version
    drive(world, FORWARD, steps=30)
    assert world.poses()[0].x_m > 6.5


def test_instant_door_pushes_a_robot_aside(world_of):
    world = world_of((6.05, 3.0, 0.0))
    world.set_door("gate", closed=True)
    drive(world, steps=30)
    leaf = shapely.Polygon(door_corners(world.plan.doors[0]))
    assert leaf.distance(shapely.Point(world.positions_m()[0])) > 0.18
    assert world.positions_m()[0] == pytest.approx((6.25, 3.0), abs=0.4)
    assert world.mishaps == {}


@pytest.mark.parametrize("motion", ["swing", "slide"])
def test_leaf_moves_at_constant_speed_and_the_door_is_closed_when_it_has_arrived(world_of, motion):
    world = world_of((2.0, 1.0, 0.0), door={"motion": motion, "time_s": 1.0, "closed": True})
    world.set_door("gate", closed=False)
    opening = drive(world, steps=12)
    assert [state.opening for state in opening] == pytest.approx([*(0.1 * i for i in range(1, 11)), 1.0, 1.0])
    assert {state.closed for state in opening} == {False}
    assert [state.motion for state in opening] == ["opens"] * 9 + ["still"] * 3
    world.set_door("gate", closed=True)
    closing = drive(world, steps=12)
    assert [state.closed for state in closing] == [False] * 9 + [True] * 3
    assert [state.motion for state in closing] == ["closes"] * 9 + ["still"] * 3


def test_leaf_waits_for_a_robot_and_does_not_push_it(world_of):
    world = world_of((6.0, 3.0, 0.0), door={"motion": "swing"})
    world.set_door("gate", closed=True)
    assert drive(world, steps=40)[-1].motion == "held"
    assert world.positions_m()[0] == pytest.approx((6.0, 3.0), abs=5e-3)
    world.set_pose(0, Pose(2.0, 2.0, 0.0))
    assert drive(world, steps=40)[-1] == DoorState(closed=True, opening=0.0)


def test_robot_does_not_push_a_leaf(world_of):
    world = world_of((4.0, 3.0, 0.0), door={"motion": "slide", "closed": True})
    drive(world, FORWARD, steps=50)
    assert world.poses()[0].x_m == pytest.approx(5.77, abs=0.01)
    assert world.door_states()["gate"] == DoorState(closed=True, opening=0.0)


def test_unknown_door_is_named(world_of):
    with pytest.raises(ValueError, match=r"^unknown door 'hatch'; known: gate$"):
        world_of((2.0, 2.0, 0.0)).set_door("hatch", closed=True)


@pytest.mark.parametrize("thing", [BOX, BARREL], ids=["box", "barrel"])
def test_robot_pushes_an_object_which_then_comes_to_rest(world_of, thing):
    world = world_of((2.0, 2.0, 0.0), objects=(thing,))
    drive(world, FORWARD, steps=60)
    pushed = world.objects()[thing.name]
    assert pushed.x_m > 3.4
    assert world.in_contact() == [True]
    drive(world, steps=10)
    rest = world.objects()[thing.name]
    assert rest.x_m - pushed.x_m < 0.15
    drive(world, steps=20)
    assert world.objects()[thing.name].x_m == pytest.approx(rest.x_m, abs=2e-3)


def test_object_that_is_too_heavy_stops_a_robot(world_of):
    heavy = BOX.model_copy(update={"mass_kg": 500.0})
    world = world_of((2.0, 2.0, 0.0), objects=(heavy,))
    drive(world, FORWARD, steps=40)
    assert world.objects()["box"].x_m == pytest.approx(3.0, abs=0.01)
    assert world.poses()[0].x_m == pytest.approx(2.6, abs=0.012)


def test_objects_are_added_moved_and_removed(world_of):
    world = world_of((2.0, 2.0, 0.0), objects=(BOX,))
    drive(world, FORWARD, steps=5)
    before = world.poses()
    world.add_object(BARREL.model_copy(update={"pose": (9.0, 4.0, 0.5)}))
    assert world.poses() == before
    assert list(world.objects()) == ["box", "drum"]
    assert world.objects()["drum"] == Pose(9.0, 4.0, pytest.approx(0.5, abs=1e-12))
    world.move_object("drum", Pose(10.0, 4.0, -1.0))
    assert world.objects()["drum"] == Pose(10.0, 4.0, pytest.approx(-1.0, abs=1e-12))
    world.remove_object("box")
    assert [obj.name for obj in world.object_states().models] == ["drum"]
    drive(world, FORWARD, steps=40)
    assert world.poses()[0].x_m > 3.5
    world.reset()
    assert world.objects() == {"box": Pose(3.0, 2.0, 0.0)}


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ((3.0, 5.8), r"is inside wall 'north'$"),
        ((5.5, 2.5), r"is inside door 'gate'$"),
        ((9.2, 4.0), r"is inside barrel 'drum'$"),
        ((2.3, 2.0), r"is inside robot_0$"),
        ((13.0, 2.0), r"is outside the plan"),
    ],
)
def test_object_is_not_put_where_something_is(world_of, place, message):
    drum = BARREL.model_copy(update={"pose": (9.0, 4.0, 0.0)})
    world = world_of((2.0, 2.0, 0.0), objects=(BOX, drum), door={"motion": "swing"})
    with pytest.raises(PlacementError, match=rf"^box 'box': pose .* {message}"):
        world.move_object("box", Pose(*place, 0.0))
    with pytest.raises(PlacementError, match=rf"^box 'other': pose .* {message}"):
        world.add_object(BOX.model_copy(update={"name": "other", "pose": (*place, 0.0)}))
    assert world.objects() == {"box": Pose(3.0, 2.0, 0.0), "drum": Pose(9.0, 4.0, 0.0)}


def test_mistakes_about_objects_are_named(world_of):
    world = world_of((2.0, 2.0, 0.0), objects=(BOX,))
    with pytest.raises(ValueError, match=r"^there is already a box 'box'$"):
        world.add_object(BOX)
    with pytest.raises(ValueError, match=r"^unknown object 'crate'; known: box$"):
        world.remove_object("crate")
    with pytest.raises(ValueError, match=r"^box 'box': pose must be finite"):
        world.move_object("box", Pose(math.nan, 2.0, 0.0))
    assert world.objects() == {"box": Pose(3.0, 2.0, 0.0)}
