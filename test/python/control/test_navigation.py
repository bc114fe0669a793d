"""Robots that drive in a true world: to a point, around things, past each other."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

from robotteamsim.control.driving.driver import places_of
from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.control.driving.navigation import Navigator
from robotteamsim.geometry import Twist
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.controllers.driving import NavigatorTuning
from robotteamsim.scenario.drives import AnyDrive, CarDrive, Drive
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

RADIUS_M = 0.2
DIFFERENTIAL = Drive()


def room(*walls: Wall, width_m: float = 10.0, depth_m: float = 6.0, blocks: Sequence[Block] = ()) -> FloorPlan:
    """A room within walls of 0.2 m; coordinates from its lower left corner."""
    w, d = width_m, depth_m
    outer = (
        Wall(name="south", start=(-0.2, -0.1), end=(w + 0.2, -0.1)),
        Wall(name="north", start=(-0.2, d + 0.1), end=(w + 0.2, d + 0.1)),
        Wall(name="west", start=(-0.1, 0.0), end=(-0.1, d)),
        Wall(name="east", start=(w + 0.1, 0.0), end=(w + 0.1, d)),
    )
    bounds = Bounds(min=(-0.2, -0.2), max=(w + 0.2, d + 0.2))
    return FloorPlan(name="room", bounds=bounds, walls=(*outer, *walls), blocks=tuple(blocks))


class Drivers:
    """Robots that each drive to one goal; those without a goal are parked."""

    def __init__(
        self,
        plan: FloorPlan,
        starts: Sequence[tuple[float, float, float]],
        goals: Sequence[tuple[float, float] | None],
        mode: str = "path",
        drive: AnyDrive = DIFFERENTIAL,
    ) -> None:
        robots = [PlacedRobot(start_pose=start, drive=drive) for start in starts]
        self.world = World(plan, robots, Run())
        self.goals = goals
        self.map = KnownMap(Building(plan), RADIUS_M, ())
        self.touched = [False] * len(robots)
        self.top_speed_mps = 0.0
        self._sensors = RobotSensors(self.world, robots, 1)
        self._navigators = [Navigator(robot, i, mode, NavigatorTuning()) for i, robot in enumerate(robots)]
        self._twists = [Twist()] * len(robots)

    def run(self, seconds: float) -> None:
        """Drive until all are at their goals, or the time is up."""
        for _ in range(round(10 * seconds)):
            if all(self.distance_m(i) < 0.1 for i, goal in enumerate(self.goals) if goal):
                return
            self.step()

    def step(self) -> None:
        self.world.step(self._twists)
        places = {i: (pose.x_m, pose.y_m) for i, pose in enumerate(self.world.poses())}
        for i, reading in enumerate(self._sensors.read()):
            self.touched[i] |= reading.in_contact
            self.top_speed_mps = max(self.top_speed_mps, abs(reading.twist.linear_x_mps))
            goal = self.goals[i]
            if goal is not None:
                others = {k: place for k, place in places.items() if k != i}
                self._twists[i] = self._navigators[i].drive(
                    self.map.grid,
                    reading.ground_truth.pose,
                    reading.ranges_m,
                    goal,
                    0.5,
                    self.world.sim_time_ns,
                    places_of(lambda others=others: others),
                )

    @property
    def time_s(self) -> float:
        return self.world.sim_time_ns * 1e-9

    def distance_m(self, robot_id: int) -> float:
        pose, goal = self.world.poses()[robot_id], self.goals[robot_id]
        assert goal is not None
        return math.dist((pose.x_m, pose.y_m), goal)


@pytest.mark.parametrize("mode", ["path", "straight"])
def test_robot_drives_straight_to_a_goal_in_sight(mode):
    drivers = Drivers(room(), [(2.0, 3.0, math.pi)], [(7.0, 4.0)], mode)
    drivers.run(20.0)
    assert drivers.distance_m(0) < 0.1
    # 5.1 m at 0.5 m/s, and turning round at the start.
    assert 10.2 < drivers.time_s < 14.0
    assert not drivers.touched[0]


def test_car_turns_round_without_turning_on_the_spot():
    car = CarDrive(kind="car", wheelbase_m=0.3, max_steering_rad=0.6)
    drivers = Drivers(room(), [(9.5, 3.0, 0.0)], [(3.0, 3.0)], drive=car)
    drivers.run(60.0)
    assert drivers.distance_m(0) < 0.1
    assert not drivers.touched[0]


def test_robot_keeps_below_the_speed_it_is_given():
    drivers = Drivers(room(), [(2.0, 3.0, 0.0)], [(7.0, 3.0)])
    drivers.run(20.0)
    assert drivers.top_speed_mps == pytest.approx(0.5, abs=1e-6)


def test_robot_stays_where_it_arrived():
    drivers = Drivers(room(), [(2.0, 3.0, 0.0)], [(4.0, 3.0)])
    drivers.run(10.0)
    for _ in range(100):
        drivers.step()
    assert drivers.distance_m(0) < 0.1


def test_robot_drives_around_a_wall_that_it_knows():
    wall = Wall(name="partition", start=(5.0, 0.0), end=(5.0, 5.0))
    drivers = Drivers(room(wall), [(4.0, 1.0, 0.0)], [(6.0, 1.0)])
    drivers.run(40.0)
    assert drivers.distance_m(0) < 0.1
    assert not drivers.touched[0]


def test_robot_without_the_map_is_held_by_a_wall():
    wall = Wall(name="partition", start=(5.0, 0.0), end=(5.0, 5.0))
    drivers = Drivers(room(wall), [(4.0, 0.5, 0.0)], [(6.0, 0.5)], mode="straight")
    drivers.run(10.0)
    assert drivers.distance_m(0) > 1.0


def test_robot_goes_through_a_door_of_ninety_centimetres():
    walls = (
        Wall(name="left", start=(5.0, 0.0), end=(5.0, 2.55)),
        Wall(name="right", start=(5.0, 3.45), end=(5.0, 6.0)),
    )
    drivers = Drivers(room(*walls), [(2.0, 1.0, 0.0)], [(8.0, 5.0)])
    drivers.run(40.0)
    assert drivers.distance_m(0) < 0.1


def test_goal_inside_an_obstacle_is_replaced_by_the_nearest_reachable_point():
    block = Block(name="core", polygon=((4.0, 2.0), (6.0, 2.0), (6.0, 4.0), (4.0, 4.0)))
    drivers = Drivers(room(blocks=[block]), [(3.0, 3.0, 0.0)], [(4.3, 3.0)])
    drivers.run(10.0)
    pose = drivers.world.poses()[0]
    assert 3.6 < pose.x_m < 3.8
    assert pose.y_m == pytest.approx(3.0, abs=0.1)
    assert not drivers.touched[0]


@pytest.mark.parametrize("offset_m", [0.0, 0.05, -0.05, 0.2])
def test_robot_passes_a_parked_robot(offset_m):
    drivers = Drivers(room(), [(2.0, 3.0, 0.0), (4.0, 3.0 + offset_m, 0.0)], [(7.0, 3.0), None])
    drivers.run(30.0)
    assert drivers.distance_m(0) < 0.1
    assert not any(drivers.touched)


def test_two_robots_that_meet_in_a_corridor_pass_each_other():
    corridor = room(width_m=12.0, depth_m=1.6)
    drivers = Drivers(corridor, [(2.0, 0.8, 0.0), (10.0, 0.8, math.pi)], [(10.0, 0.8), (2.0, 0.8)])
    drivers.run(60.0)
    assert max(drivers.distance_m(i) for i in (0, 1)) < 0.1


def test_robots_that_change_places_do_not_block_each_other():
    corners = [(2.0, 1.0), (8.0, 5.0), (2.0, 5.0), (8.0, 1.0), (5.0, 1.0), (5.0, 5.0)]
    goals = [(8.0, 5.0), (2.0, 1.0), (8.0, 1.0), (2.0, 5.0), (5.0, 5.0), (5.0, 1.0)]
    drivers = Drivers(room(), [(x, y, 0.0) for x, y in corners], goals)
    drivers.run(60.0)
    assert max(drivers.distance_m(i) for i in range(6)) < 0.1


def test_three_robots_pass_a_door_one_after_the_other():
    walls = (
        Wall(name="left", start=(5.0, 0.0), end=(5.0, 2.5)),
        Wall(name="right", start=(5.0, 3.5), end=(5.0, 6.0)),
    )
    starts = [(3.5, 2.0, 0.0), (3.5, 3.0, 0.0), (3.5, 4.0, 0.0)]
    drivers = Drivers(room(*walls), starts, [(7.0, 4.0), (7.0, 3.0), (7.0, 2.0)])
    drivers.run(60.0)
    assert max(drivers.distance_m(i) for i in range(3)) < 0.1


def test_two_robots_from_either_side_of_a_door_both_get_through():
    walls = (
        Wall(name="left", start=(5.0, 0.0), end=(5.0, 2.5)),
        Wall(name="right", start=(5.0, 3.5), end=(5.0, 6.0)),
    )
    drivers = Drivers(room(*walls), [(3.0, 3.0, 0.0), (7.0, 3.0, math.pi)], [(7.0, 3.0), (3.0, 3.0)])
    drivers.run(60.0)
    assert max(drivers.distance_m(i) for i in (0, 1)) < 0.1
