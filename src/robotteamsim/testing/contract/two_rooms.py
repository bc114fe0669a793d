"""The building in which worlds are tested: two rooms with a gate between them."""

from __future__ import annotations

from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot, Run

WALLS = (
    Wall(name="south", start=(0.0, 0.1), end=(12.0, 0.1)),
    Wall(name="north", start=(0.0, 5.9), end=(12.0, 5.9)),
    Wall(name="west", start=(0.1, 0.2), end=(0.1, 5.8)),
    Wall(name="east", start=(11.9, 0.2), end=(11.9, 5.8)),
    Wall(name="middle south", start=(6.0, 0.2), end=(6.0, 2.5), thickness_m=0.1),
    Wall(name="middle north", start=(6.0, 3.5), end=(6.0, 5.8), thickness_m=0.1),
)
BLOCKS = (
    Block(name="core", polygon=((8.0, 1.0), (10.0, 1.0), (10.0, 1.5), (8.5, 1.5), (8.5, 3.0), (8.0, 3.0))),
    Block(name="pillar", kind="pillar", polygon=((3.0, 4.0), (3.0, 4.5), (3.5, 4.5), (3.5, 4.0))),
)


def two_rooms(**door: object) -> FloorPlan:
    """Two rooms with a gate between them, from (6, 2.5) to (6, 3.5); keywords are keys of its door."""
    gate = Door(name="gate", start=(6.0, 2.5), end=(6.0, 3.5), **door)
    return FloorPlan(name="two rooms", bounds=Bounds(max=(12.0, 6.0)), walls=WALLS, blocks=BLOCKS, doors=(gate,))


def scenario_of(
    kind: str, *robots: tuple[float, float, float] | PlacedRobot, door: dict[str, object] | None = None, **keys: object
) -> Scenario:
    """Return a scenario in the two rooms, with robots at start poses or of other forms; `door` has keys of the gate."""
    placed = tuple(robot if isinstance(robot, PlacedRobot) else PlacedRobot(start_pose=robot) for robot in robots)
    return Scenario(name="test", plan=two_rooms(**(door or {})), robots=placed, run=Run(world=kind), **keys)
