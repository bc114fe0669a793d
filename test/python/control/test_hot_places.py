"""Hot places that robots know: paths around them, and what they tell their team."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.rdpso.team import Best, RdpsoUpdate
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import EVERYBODY, OUTSIDE, Message
from robotteamsim.scenario import load, load_floor_plan
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot
from robotteamsim.scenario.sensors import HeatReading
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading
from robotteamsim.simulation import Simulation
from robotteamsim.swarm import SwarmState

ODOMETRY = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())


def reading(*hot_m: tuple[float, float]) -> RobotReading:
    nothing_m = np.zeros(0, np.float32)
    heat = {"heat": HeatReading(20.0, hot_m, (80.0,) * len(hot_m))}
    return RobotReading(ODOMETRY.pose, Twist(), ODOMETRY, nothing_m, in_contact=False, sensors=heat)


def test_paths_lead_around_known_hot_blocks():
    plan = load_floor_plan("garage")
    start, goal = (20.0, 7.0), (40.0, 7.0)
    hot = tuple((row, 30) for row in range(2, 10))  # 30 to 31 m along the south aisle, y from 2 to 10 m
    free, around = known_map(Building(plan), 0.2).grid, known_map(Building(plan), 0.2, (), hot).grid
    assert free.is_line_free(start, goal)
    assert not around.is_line_free(start, goal)
    corners = np.array(around.waypoints(start, goal, 100.0))
    lengths = np.diff(corners, axis=0)
    steps = np.concatenate([corners[i] + np.linspace(0, 1, 200)[:, None] * lengths[i] for i in range(len(lengths))])
    inside = (steps[:, 0] > 30) & (steps[:, 0] < 31) & (steps[:, 1] > 2) & (steps[:, 1] < 10)
    assert not inside.any()


def test_map_follows_hot_places_seen_and_heard_at_most_every_five_seconds():
    places = HotPlaces(load_floor_plan("garage"), 60.0)
    places.look(reading((3.2, 4.7), (3.9, 4.1)))
    assert places.in_sight == ((4, 3),)
    assert places.update(10**9)
    assert places.blocked == ((4, 3),)
    places.hear([(7, 7)])
    assert not places.update(5 * 10**9)
    assert places.update(6 * 10**9)
    assert places.blocked == ((4, 3), (7, 7))
    places.look(reading())  # what it sees no longer may still be hot
    assert places.in_sight == ()
    assert not places.update(60 * 10**9)


def test_robot_that_heat_surrounds_leaves_to_the_nearest_cold_place():
    plan = load_floor_plan("garage")
    places = HotPlaces(plan, 60.0)
    assert places.way_out(known_map(Building(plan), 0.2).grid, (20.5, 7.5)) is None
    places.hear((row, column) for row in range(4, 11) for column in range(18, 22))
    assert places.is_hot((20.5, 7.5))
    places.update(10**9)
    grid = known_map(Building(plan), 0.2, (), places.blocked).grid
    way_out = places.way_out(grid, (20.5, 7.5))
    assert not places.is_hot(way_out)
    assert way_out[0] == pytest.approx(22.3, abs=0.15)  # half a metre of body and margin beside the blocks
    assert way_out[1] == pytest.approx(7.5, abs=0.1)
    assert places.way_out(grid, (25.0, 7.5)) is None


def test_area_is_reached_if_a_path_leads_to_any_piece_of_its_floor():
    plan = load_floor_plan("garage")
    start, center = (20.0, 7.0), (40.0, 7.0)
    wall = {(row, 40) for row in range(13)}  # from the south wall to beyond the core, through the area's middle
    ring = {(row, column) for row in range(4, 10) for column in (37, 42)} | {
        (r, c) for r in (4, 9) for c in range(37, 43)
    }
    disc = {(row, column) for row in range(4, 10) for column in range(37, 43)}
    for hot, reached in ((set(), True), (wall, True), (ring, False), (disc, False)):
        assert known_map(Building(plan), 0.2, (), tuple(sorted(hot))).reaches(start, center, 2.0) == reached


def hot_update(iteration: int, blocks: Sequence[tuple[int, int]], known_best: Best | None) -> Message:
    """Return what an excluded robot far away sends that sees hot blocks."""
    swarm = {"position": (1.0, 9.0), "swarm_id": OUTSIDE, "swarm": SwarmState(), "hot": tuple(blocks)}
    bests = {"loudest": None, "local_best": None, "known_best": known_best}
    return Message(2, EVERYBODY, RdpsoUpdate(robot_id=2, iteration=iteration, epoch=1, **swarm, **bests).to_json())


def driven_m(team, seconds: int, blocks_at, known_best: Best | None = None) -> float:
    """Return how much nearer to the area a robot comes. Args: blocks_at: returns the blocks heard in an iteration."""
    before = team.world.poses()[0]
    for second in range(seconds):
        for _ in range(10):
            now = team.world.sim_time_ns // 10**9
            team.hear_messages = [hot_update(now, blocks_at(second), known_best)]
            team.step()
    return team.world.poses()[0].x_m - before.x_m


def test_swarm_keeps_its_speed_while_its_map_changes(team, hall_scenario):
    robots = (PlacedRobot(start_pose=(2.0, 5.0, 0.0)), PlacedRobot(start_pose=(2.0, 6.0, 0.0)))
    mission = Mission(areas=(Area(name="east", center=(18.0, 5.0)),))

    def moved_m(blocks_at) -> float:
        return driven_m(team(hall_scenario(robots=robots, mission=mission)), 20, blocks_at)

    steady_m = moved_m(lambda second: ())
    changing_m = moved_m(lambda second: [(0, column) for column in range(second // 5 + 1)])
    assert steady_m > 4.0
    assert changing_m == steady_m  # the hot blocks are nowhere near


def test_swarm_follows_no_voice_into_the_heat(team, hall_scenario):
    robots = (PlacedRobot(start_pose=(8.0, 5.0, 0.0)), PlacedRobot(start_pose=(8.0, 6.0, 0.0)))
    mission = Mission(areas=(Area(name="east", center=(18.0, 5.0)),))

    def moved_m(*blocks: tuple[int, int]) -> float:
        hall = team(hall_scenario(robots=robots, mission=mission))
        hall.hear = lambda position: VoiceReading(20.0, True, (7.5, 8.5), 30.0)  # a victim behind the robots
        return driven_m(hall, 8, lambda second: blocks)

    assert moved_m() < 0.0
    assert moved_m((8, 7), (8, 6)) > 0.3


def test_best_from_before_the_heat_does_not_count_as_the_best_of_the_swarm(team, hall_scenario):
    robots = (PlacedRobot(start_pose=(2.0, 5.0, 0.0)), PlacedRobot(start_pose=(2.0, 6.0, 0.0)))
    mission = Mission(areas=(Area(name="east", center=(18.0, 5.0)),))
    hall = team(hall_scenario(robots=robots, mission=mission))
    wall = [(row, 9) for row in range(8)]  # the way around it is longer by several metres
    driven_m(hall, 14, lambda second: wall, Best(-9.5, (8.5, 5.0)))
    assert not any(decision.excluded for decision in hall.decisions)
    assert max(decision.search_counter for decision in hall.decisions) < 5


@pytest.mark.slow
def test_robots_send_hot_places_and_nothing_without_a_fire():
    def payloads(*overrides: str) -> list[str]:
        simulation = Simulation(load("garage_fire", ["run.seed=7", *overrides]))
        decisions = [decision for _ in range(300) for decision in simulation.step().decisions]
        return [message.payload for decision in decisions for message in decision.outbox]

    near = [
        "fire.fuel=[{name: boxes, center: [8, 5], radius_m: 3, growth: ultra_fast}]",
        "fire.ignitions=[{position: [9.2, 5.2]}]",
    ]
    assert any('"hot":[[' in payload for payload in payloads(*near))
    assert not any('"hot"' in payload for payload in payloads("fire.ignitions=[]"))


def test_place_above_a_limit_with_a_fraction_is_hot():
    hot = HotPlaces(load_floor_plan("garage"), 60.5)
    warm = {"heat": HeatReading(20.0, ((30.5, 7.5),), (60.7,))}
    nothing_m = np.zeros(0, np.float32)
    hot.look(RobotReading(ODOMETRY.pose, Twist(), ODOMETRY, nothing_m, in_contact=False, sensors=warm))
    assert hot.in_sight == ((7, 30),)
