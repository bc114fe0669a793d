"""Hot places that robots know: paths around them, and what they tell their team."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.scenario import load, load_floor_plan
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.sensors import HeatReading
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.simulation import Simulation

ODOMETRY = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())


def reading(*hot_m: tuple[float, float]) -> RobotReading:
    nothing_m = np.zeros(0, np.float32)
    heat = {"heat": HeatReading(20.0, hot_m)}
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
    places = HotPlaces(load_floor_plan("garage"))
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
    places = HotPlaces(plan)
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
