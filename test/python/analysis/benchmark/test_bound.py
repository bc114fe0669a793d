"""The lower bound of a search: by hand, its lengths against exact ones, and below every measured time."""

from __future__ import annotations

import json
import math
from itertools import pairwise

import pytest

from robotteamsim import __version__
from robotteamsim.analysis.benchmark.bound import OCTILE, OptimisticFloor, search_bound
from robotteamsim.campaign.design import Trial
from robotteamsim.campaign.trial import run_trial
from robotteamsim.errors import CampaignError
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Mission, PlacedRobot, Victim, Voice
from robotteamsim.setup import resolve

ONE = (PlacedRobot(start_pose=(3.0, 5.0, 0.0)),)
SPEED_MPS = 0.7


def with_victims(*places: tuple[float, float]) -> Mission:
    return Mission(victims=tuple(Victim(name=f"v{i}", position=place) for i, place in enumerate(places)))


def with_wall(plan, top_m: float):
    """A wall across the hall at x = 10 m with a gap above it."""
    wall = Wall(name="middle", start=(10.0, 0.0), end=(10.0, top_m))
    return plan.model_copy(update={"walls": (*plan.walls, wall)})


def test_bound_in_an_empty_hall_is_the_straight_line_to_the_disc_over_the_top_speed(hall_scenario):
    scenario = hall_scenario(robots=ONE, mission=with_victims((13.0, 5.0)))
    assert search_bound(resolve(scenario)).time_s == pytest.approx(9.0 / SPEED_MPS)
    # Two in opposite directions: the nearer first, 1 m to its disc, and back.
    scenario = hall_scenario(robots=ONE, mission=with_victims((13.0, 5.0), (1.0, 5.0)))
    assert search_bound(resolve(scenario)).time_s == pytest.approx((1.0 + 10.0) / SPEED_MPS)


def test_second_robot_shares_the_work(hall_scenario):
    robots = (*ONE, PlacedRobot(start_pose=(17.0, 5.0, 0.0)))
    scenario = hall_scenario(robots=robots, mission=with_victims((5.0, 5.0), (13.0, 5.0)))
    assert search_bound(resolve(scenario)).time_s == pytest.approx(3.0 / SPEED_MPS)


def test_length_around_a_wall_is_below_the_exact_one_and_near_it(hall_scenario):
    plan = with_wall(hall_scenario().plan, 8.0)
    floor = OptimisticFloor(Building(plan), 0.2)
    ((length_m,),) = floor.lengths_m([(6.0, 3.0)], [(14.0, 3.0)], 0.0)[0]
    # Around the corners (9.9, 8) and (10.1, 8), whose clearance only makes the path longer.
    corners = [(6.0, 3.0), (9.9, 8.0), (10.1, 8.0), (14.0, 3.0)]
    exact_m = sum(math.dist(a, b) for a, b in pairwise(corners))
    assert 0.9 * OCTILE * exact_m < length_m <= exact_m + 0.2


def test_victim_behind_walls_is_named_and_takes_forever(hall_scenario):
    plan = with_wall(hall_scenario().plan, 10.0)
    bound = search_bound(resolve(hall_scenario(plan=plan, robots=ONE, mission=with_victims((14.0, 5.0), (5.0, 5.0)))))
    assert bound.time_s == math.inf
    assert bound.unreachable == ("v0",)


def test_victim_just_behind_a_wall_is_saved_through_it(hall_scenario):
    plan = with_wall(hall_scenario().plan, 10.0)
    bound = search_bound(resolve(hall_scenario(plan=plan, robots=ONE, mission=with_victims((10.4, 5.0)))))
    assert bound.unreachable == ()
    assert bound.time_s == pytest.approx((10.4 - 3.0 - 1.0) / SPEED_MPS)


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ["greedy", "boustrophedon", "rdpso"])
def test_no_mission_is_faster_than_its_bound(hall_scenario, algorithm):
    plan = with_wall(hall_scenario().plan, 7.0)
    scenario = hall_scenario(
        plan=plan,
        mission=Mission(random_victims=2, time_limit_s=240.0),
        control={"algorithm": algorithm},
        voice=Voice(),
    )
    solved = 0
    for seed in range(6):
        outcome = run_trial(scenario, Trial(0, 1, seed), __version__)
        seeded = scenario.model_copy(update={"run": scenario.run.model_copy(update={"seed": seed})})
        bound_s = search_bound(resolve(seeded)).time_s
        saved = [victim["saved_s"] for victim in json.loads(outcome.details)["victims"].values()]
        if None not in saved:
            solved += 1
            assert bound_s <= max(saved)
    assert solved >= 2


def test_schedule_is_rejected_because_it_would_break_the_bound(hall_scenario):
    event = ScheduledEvent(at_s=5.0, noise_db=20.0)
    with pytest.raises(CampaignError, match="hall: schedule: not allowed: the bound assumes that nothing is changed"):
        search_bound(resolve(hall_scenario(schedule=(event,))))
