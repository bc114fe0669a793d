"""How fast a team knew a building, and how right its maps were."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.recording.exploration import ExplorationLog, map_error
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.plan import UNKNOWN
from robotteamsim.scenario.sections import Laser, Mission, PlacedRobot
from robotteamsim.simulation import Observer, Simulation

CORNER = np.zeros((200, 200), bool)
CORNER[50, 50:150] = CORNER[50:120, 50] = True


def test_walls_of_which_a_quarter_is_in_the_open_are_right_by_three_quarters():
    found = np.zeros_like(CORNER)
    found[50, 60:90] = True  # on the wall, 10 cm next to it, and far from it
    found[51, 90:120] = True
    found[100, 100:120] = True
    right, aligned = map_error(found, CORNER)
    assert right == 0.75
    assert aligned >= 0.75


@pytest.mark.parametrize("turn_rad", [0.0, 0.03])
def test_alignment_finds_the_shift_and_the_turn_of_a_map(turn_rad):
    rows, columns = np.argwhere(CORNER).T - 50
    found = np.zeros_like(CORNER)
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    found[
        np.rint(54 + cos * rows - sin * columns).astype(int), np.rint(46 + sin * rows + cos * columns).astype(int)
    ] = True
    right, aligned = map_error(found, CORNER)
    assert right < 0.2
    assert aligned > 0.98


def test_map_without_walls_has_no_wrong_one():
    nothing = np.zeros_like(CORNER)
    assert map_error(nothing, CORNER) == (1.0, 1.0)
    assert map_error(CORNER, nothing) == (0.0, 0.0)


class Known(Observer):
    """An observer that counts the known cells of robot 0, and the characters that robots send."""

    def __init__(self, simulation):
        self.simulation, self.num_bytes, self.shares = simulation, 0, []

    def step(self, record):
        (guard, *_) = self.simulation.controllers.guards
        self.shares.append(np.mean(guard.controller.found.cells[15:85, 5:195] != UNKNOWN))
        self.num_bytes += sum(len(m.payload) for decision in record.decisions for m in decision.outbox)


@pytest.fixture
def explored(hall_scenario):
    """Return a function that lets two robots explore the hall with a wall; it returns the log, and the other count."""

    def explored(limit_s=120.0):
        laser = Laser(beams=361, angle_min_rad=-math.pi, angle_max_rad=math.pi, range_max_m=6.0)
        plan = hall_scenario().plan
        wall = Wall(name="middle", start=(12.0, 0.2), end=(12.0, 8.0))
        simulation = Simulation(
            hall_scenario(
                plan=plan.model_copy(update={"walls": (*plan.walls, wall)}),
                robots=tuple(PlacedRobot(start_pose=(3.0, y_m, 0.0), laser=laser) for y_m in (4.0, 6.0)),
                mission=Mission(time_limit_s=limit_s),
                control={"algorithm": "frontier", "map": "unknown", "localisation": "ground_truth"},
            )
        )
        log, known = ExplorationLog(simulation), Known(simulation)
        result = simulation.run([log, known])
        return log.exploration, known, result

    return explored


def test_hall_is_known_in_time_and_its_walls_are_right(explored):
    found, known, result = explored()
    assert found.known > 0.99
    assert 0.0 < found.t90_s < found.t99_s < result.time_s
    # All floor but that within 0.5 m of the outer walls, and a few cells of the wall.
    assert 1e-1 * np.argmax(np.array(known.shares) > 0.9) == pytest.approx(found.t90_s, abs=3.0)
    assert found.right > 0.99
    assert found.bytes_per_s == pytest.approx(known.num_bytes / 2 / result.time_s, rel=0.05)


def test_what_was_not_reached_has_no_time(explored):
    found, _, _ = explored(limit_s=3.0)
    assert found.known < 0.9
    assert (found.t90_s, found.t99_s) == (None, None)


def test_robots_that_know_the_building_have_no_such_measures(hall_scenario):
    simulation = Simulation(hall_scenario(mission=Mission(time_limit_s=1.0)))
    log = ExplorationLog(simulation)
    simulation.run([log])
    assert (log.exploration, log.values()) == (None, {})
