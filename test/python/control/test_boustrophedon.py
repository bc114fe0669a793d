"""The boustrophedon sweep: its lines by hand, its cells around a block, and a sweep that is driven."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from robotteamsim.control import make_controller
from robotteamsim.control.baselines.boustrophedon import shares, sweep
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Task
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Block
from robotteamsim.scenario.sections import Area, Mission, PlacedRobot, Victim, Voice
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

SPACING_M = 2.0
START = (1.0, 1.0)


def swept(plan, spacing_m: float = SPACING_M):
    return sweep(Building(plan), 0.2, spacing_m, START)


def test_empty_hall_is_one_cell_of_parallel_lines_back_and_forth(hall_scenario):
    segments = swept(hall_scenario().plan)
    # 20 x 10 m: five lines along x, 2 m apart, each from wall to wall less 0.2 m of wall and 0.25 m of clearance.
    assert len(segments) == 5
    assert [round(start[1], 2) for start, _ in segments] == pytest.approx([1.05, 3.05, 5.05, 7.05, 9.05])
    for (x0, y0), (x1, y1) in segments:
        assert y0 == y1
        assert sorted((x0, x1)) == pytest.approx([0.5, 19.5], abs=0.11)
    assert all(math.dist(a[1], b[0]) == pytest.approx(SPACING_M, abs=0.01) for a, b in pairwise(segments))


def test_block_splits_the_floor_into_four_cells_of_which_each_is_finished_before_the_next(hall_scenario):
    hall = hall_scenario().plan
    block = Block(name="core", polygon=((8.0, 4.0), (12.0, 4.0), (12.0, 6.0), (8.0, 6.0)))
    segments = swept(hall.model_copy(update={"blocks": (block,)}), 1.0)
    halves = ["west" if max(a[0], b[0]) < 9.0 else "east" if min(a[0], b[0]) > 11.0 else "whole" for a, b in segments]
    # Below the block, on either side of it, above it: no side is left before its lines are done.
    runs = [half for i, half in enumerate(halves) if i == 0 or half != halves[i - 1]]
    assert runs.count("west") == runs.count("east") == 1
    assert halves.count("west") == halves.count("east") >= 2


def test_every_reachable_place_is_near_a_line(hall_scenario):
    segments = swept(hall_scenario().plan)
    for x in range(1, 20):
        for y in range(1, 10):
            assert min(abs(y - a[1]) for a, b in segments if min(a[0], b[0]) <= x <= max(a[0], b[0])) <= SPACING_M / 2


def test_shares_begin_at_equal_distances_along_the_sweep():
    # Four lines of 10 m, 1 m apart: the lines begin at 0, 11, 22 and 33 m of 43 m.
    lines = tuple(
        ((0.0, float(i)), (10.0, float(i))) if i % 2 == 0 else ((10.0, float(i)), (0.0, float(i))) for i in range(4)
    )
    assert shares(lines, 1) == (0,)
    assert shares(lines, 2) == (0, 2)
    assert shares(lines, 4) == (0, 1, 2, 3)


def test_robots_sweep_different_lines_and_follow_a_voice(team, hall_scenario):
    control = {"algorithm": "boustrophedon", "spacing_m": SPACING_M}
    hall = team(hall_scenario(control=control))
    hall.task = Task(running=True, epoch=1)
    goals = {i: set() for i in range(2)}
    for _ in range(600):
        for i, decision in enumerate(hall.step()):
            goals[i].add(decision.goal_m[1])
    assert goals[0].isdisjoint(goals[1])
    victim = (10.0, 5.0)
    hall.new_epoch()
    hall.hear = lambda position: VoiceReading(50.0, True, victim, 60.0)
    hall.run(1.2)
    assert all(decision.goal_m == victim for decision in hall.step())


def test_voice_that_does_not_become_louder_is_given_up_there_until_the_voices_change(team, hall_scenario):
    areas = tuple(Area(name=f"area_{i}", center=(5.0 * i + 2.0, 5.0)) for i in range(3))
    hall = team(hall_scenario(mission=Mission(areas=areas), control={"algorithm": "boustrophedon"}))
    outside = (10.0, 9.95)  # In the wall: no robot ever stands next to it.
    hall.hear = lambda position: VoiceReading(50.0, True, outside, 60.0)
    assert all(decision.goal_m == outside for decision in hall.step())
    hall.run(12.0)
    assert all(decision.goal_m != outside for decision in hall.step())
    hall.new_epoch()
    hall.run(1.1)
    assert all(decision.goal_m == outside for decision in hall.step())


def test_plan_in_which_no_path_can_begin_is_rejected(hall_scenario, closet):
    robots = (PlacedRobot(start_pose=(0.28, 0.28, 0.0), radius_m=0.15),)
    scenario = hall_scenario(plan=closet, robots=robots, mission=Mission(), control={"algorithm": "boustrophedon"})
    with pytest.raises(ScenarioError, match=r"hall: control.spacing_m: no line of the sweep crosses floor that"):
        make_controller(0, resolve(scenario))


@pytest.mark.parametrize("algorithm", ["boustrophedon", "infotaxis"])
def test_last_area_is_not_entered_before_the_floor_has_been_searched(hall_scenario, algorithm):
    areas = (Area(name="start", center=(3.0, 5.0)), Area(name="gate", center=(10.0, 5.0)))
    victims = (Victim(name="ann", position=(18.5, 1.0)), Victim(name="bob", position=(18.5, 9.0)))
    scenario = hall_scenario(
        mission=Mission(areas=areas, victims=victims, time_limit_s=300.0),
        control={"algorithm": algorithm},
        voice=Voice(noise_db=60.0),
    )
    simulation = Simulation(scenario)
    simulation.run()
    assert simulation.mission.status.victims == ("saved", "saved")


def test_robots_enter_the_last_area_after_all_have_swept_their_shares(hall_scenario):
    areas = (Area(name="start", center=(3.0, 5.0)), Area(name="gate", center=(10.0, 5.0)))
    scenario = hall_scenario(mission=Mission(areas=areas, time_limit_s=600.0), control={"algorithm": "boustrophedon"})
    simulation = Simulation(scenario)
    controllers = [guard.controller for guard in simulation.controllers.guards]
    simulation.mission.start()
    while simulation.mission.status.state != "ended":
        before = [controller.is_searched for controller in controllers]
        simulation.step()
    assert all(before)
    assert simulation.mission.status.end == "areas_explored"
