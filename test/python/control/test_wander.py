from __future__ import annotations

import math

from robotteamsim import rng
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.driving.wander import Wander, free_end
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.controllers.driving import WanderTuning


def test_leg_ends_before_the_wall(hall_scenario):
    free_space = known_map(Building(hall_scenario().plan), 0.2)
    x, y = free_end(free_space, (3.05, 5.05), math.pi, 8.0)
    assert y == 5.05
    # The wall's face is at 0.2 m, and the body needs 0.25 m.
    assert 0.4 < x < 0.6


def test_leg_goes_on_until_its_end_is_reached(hall_scenario):
    free_space = known_map(Building(hall_scenario().plan), 0.2)
    wander = Wander(WanderTuning(), rng.stream(1, "wander", 0), 0.5)
    goal = wander.goal(free_space, (10.0, 5.0), 0.0)
    assert wander.goal(free_space, (10.1, 5.0), 1.0) == goal
    assert wander.goal(free_space, goal, 2.0) != goal


def test_leg_that_takes_too_long_is_given_up(hall_scenario):
    free_space = known_map(Building(hall_scenario().plan), 0.2)
    wander = Wander(WanderTuning(), rng.stream(1, "wander", 0), 0.5)
    goal = wander.goal(free_space, (10.0, 5.0), 0.0)
    assert wander.goal(free_space, (10.0, 5.0), 60.0) != goal


def test_wanderers_get_around_and_send_nothing(team, hall_scenario):
    hall = team(hall_scenario(control={"algorithm": "random_walk"}))
    cells = set()
    for _ in range(1200):
        decisions = hall.step()
        assert not any(decision.outbox or decision.excluded for decision in decisions)
        cells |= {(int(pose.x_m / 2.0), int(pose.y_m / 2.0)) for pose in hall.world.poses()}
    assert len(cells) > 15
