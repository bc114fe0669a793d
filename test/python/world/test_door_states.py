"""The states of doors and their version."""

from __future__ import annotations

from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan
from robotteamsim.scenario.sections import Run
from robotteamsim.world import World
from robotteamsim.world.doors import DoorChange, DoorState, DoorStates

CLOSED, OPEN = DoorState(closed=True, opening=0.0), DoorState(closed=False, opening=1.0)
PLAN = FloorPlan(
    name="plan",
    bounds=Bounds(max=(10.0, 10.0)),
    doors=(
        Door(name="front", start=(1.0, 1.0), end=(2.0, 1.0), closed=True),
        Door(name="back", start=(3.0, 1.0), end=(4.0, 1.0)),
    ),
)


def test_doors_start_as_in_the_plan_and_in_its_order() -> None:
    doors = DoorStates.at_start(PLAN)
    assert list(doors.items()) == [("front", CLOSED), ("back", OPEN)]
    assert (doors.version, doors.closed()) == (0, {"front": True, "back": False})


def test_version_of_a_world_grows_with_each_change_and_with_nothing_else() -> None:
    world = World(PLAN, [], Run())
    start = world.door_states()
    assert start == DoorStates.at_start(PLAN)
    assert start.version == 0
    world.set_door("front", True)
    world.step([])
    assert world.door_states() is start
    world.set_door("front", False)
    changed = world.door_states()
    assert (changed.version, dict(changed)) == (1, {"front": OPEN, "back": OPEN})
    world.reset()
    assert (world.door_states().version, world.door_states()["front"]) == (2, CLOSED)


def test_changes_are_the_doors_that_differ() -> None:
    start = DoorStates.at_start(PLAN)
    later = DoorStates({"front": OPEN, "back": OPEN}, version=1)
    assert later.changes_since(start) == [DoorChange("front", CLOSED, OPEN)]
    assert later.closed_since(start) == {"front": False}
    assert later.changes_since(later) == []


def test_door_whose_leaf_moves_is_not_closed_before_it_has_arrived() -> None:
    start = DoorStates.at_start(PLAN)
    moving = DoorStates({"front": CLOSED, "back": DoorState(closed=False, opening=0.5, motion="closes")}, version=1)
    assert [change.name for change in moving.changes_since(start)] == ["back"]
    assert moving.closed_since(start) == {}
