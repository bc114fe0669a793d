from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.control.driving.known_map import UNREACHABLE_M, KnownMap
from robotteamsim.control.rdpso.door_beliefs import DoorBeliefs
from robotteamsim.control.rdpso.team import Sighting, parse_update
from robotteamsim.geometry import Pose
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.controllers.driving import DoorTuning
from robotteamsim.scenario.floor_plan import Door, FloorPlan, Wall
from robotteamsim.scenario.sections import Area, Laser, Mission, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World


@pytest.fixture
def plan(hall_scenario) -> FloorPlan:
    """The hall, cut in two by a wall at x = 10 with doors at y = 2 and y = 8."""
    hall = hall_scenario().plan
    walls = (
        Wall(name="low", start=(10.0, 0.2), end=(10.0, 1.5)),
        Wall(name="middle", start=(10.0, 2.5), end=(10.0, 7.5)),
        Wall(name="high", start=(10.0, 8.5), end=(10.0, 9.8)),
    )
    doors = (Door(name="a", start=(10.0, 1.5), end=(10.0, 2.5)), Door(name="b", start=(10.0, 7.5), end=(10.0, 8.5)))
    return hall.model_copy(update={"walls": (*hall.walls, *walls), "doors": doors})


def look(plan: FloorPlan, beliefs: DoorBeliefs, x: float, y: float, closed: bool, iteration: int = 1) -> None:
    robots = [PlacedRobot(start_pose=(x, y, 0.0))]
    world = World(plan, robots, Run())
    world.set_door("a", closed)
    (reading,) = RobotSensors(world, robots, 1).read()
    beliefs.look(Pose(x, y, 0.0), reading.ranges_m, iteration)


def test_robot_sees_that_an_open_door_was_closed(plan):
    beliefs = DoorBeliefs(plan, Laser(), DoorTuning())
    look(plan, beliefs, 8.0, 2.2, closed=False)
    assert beliefs.changed == ()
    look(plan, beliefs, 8.0, 2.2, closed=True, iteration=7)
    assert beliefs.changed == (("a", True),)
    assert beliefs.sightings == (Sighting("a", True, 7),)


def test_robot_sees_that_the_door_is_open_again(plan):
    beliefs = DoorBeliefs(plan, Laser(), DoorTuning())
    look(plan, beliefs, 8.0, 2.2, closed=True, iteration=7)
    look(plan, beliefs, 8.5, 1.8, closed=False, iteration=9)
    assert beliefs.changed == ()
    assert beliefs.sightings == (Sighting("a", False, 9),)


def test_door_out_of_sight_stays_as_believed(plan):
    beliefs = DoorBeliefs(plan, Laser(), DoorTuning())
    look(plan, beliefs, 3.0, 2.0, closed=True)
    assert beliefs.sightings == ()


def test_robot_in_the_doorway_is_not_a_closed_door(plan):
    robots = [PlacedRobot(start_pose=(8.0, 2.0, 0.0)), PlacedRobot(start_pose=(10.0, 2.0, 0.0))]
    reading = RobotSensors(World(plan, robots, Run()), robots, 1).read()[0]
    beliefs = DoorBeliefs(plan, Laser(), DoorTuning())
    beliefs.look(Pose(8.0, 2.0, 0.0), reading.ranges_m, 1)
    assert beliefs.sightings == ()


def test_later_sighting_of_a_teammate_is_taken_over(plan):
    beliefs = DoorBeliefs(plan, Laser(), DoorTuning())
    beliefs.hear((Sighting("a", True, 5),))
    beliefs.hear((Sighting("a", False, 3), Sighting("unknown", True, 9)))
    assert beliefs.changed == (("a", True),)


def test_sightings_heard_in_either_order_give_one_belief(plan):
    sightings = [
        (Sighting("a", True, 5),),
        (Sighting("a", False, 5),),
        (Sighting("b", True, 2), Sighting("a", False, 4)),
    ]
    forward, backward = (DoorBeliefs(plan, Laser(), DoorTuning()) for _ in range(2))
    for heard in sightings:
        forward.hear(heard)
    for heard in reversed(sightings):
        backward.hear(heard)
    assert forward.sightings == backward.sightings == (Sighting("a", True, 5), Sighting("b", True, 2))


def test_closed_door_lengthens_the_path(plan):
    near, far = (9.0, 2.0), (11.0, 2.0)
    open_m = KnownMap(Building(plan), 0.2, ()).distance_m(far, near)
    around_m = KnownMap(Building(plan), 0.2, (("a", True),)).distance_m(far, near)
    assert open_m == pytest.approx(2.0, abs=0.2)
    assert around_m == pytest.approx(2.0 * math.dist((9.0, 2.0), (10.0, 8.0)), rel=0.12)
    shut = KnownMap(Building(plan), 0.2, (("a", True), ("b", True)))
    assert shut.distance_m(far, near) == pytest.approx(UNREACHABLE_M + 2.0)
    assert math.dist(shut.nearest_by_path(far, near, 1.5)[0], far) < 2.0


def test_team_finds_the_other_door_when_the_nearer_one_was_closed(team, hall_scenario, plan):
    robots = (PlacedRobot(start_pose=(6.0, 2.0, 0.0)), PlacedRobot(start_pose=(6.0, 3.0, 0.0)))
    mission = Mission(areas=(Area(name="behind", center=(14.0, 2.0)),))
    hall = team(hall_scenario(plan=plan, robots=robots, mission=mission))
    hall.world.set_door("a", True)
    hall.run(120.0)
    assert min(math.dist((pose.x_m, pose.y_m), (14.0, 2.0)) for pose in hall.world.poses()) < 2.0
    updates = [parse_update(m.payload) for _ in range(15) for decision in hall.step() for m in decision.outbox]
    assert {update.robot_id for update in updates} == {0, 1}
    assert all([(s.door, s.closed) for s in update.doors if s.closed] == [("a", True)] for update in updates)


def test_scan_with_infinite_ranges_is_read(plan):
    beliefs = DoorBeliefs(plan, Laser(no_return="inf"), DoorTuning())
    beliefs.look(Pose(8.0, 2.0, 0.0), np.full(181, np.inf, dtype=np.float32), 1)
    assert beliefs.sightings == ()
