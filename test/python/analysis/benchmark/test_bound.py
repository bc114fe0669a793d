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
from robotteamsim.scenario import from_mapping
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.scenario import Scenario
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
    assert search_bound(resolve(scenario)) == pytest.approx(9.0 / SPEED_MPS)
    # Two in opposite directions: the nearer first, 1 m to its disc, and back.
    scenario = hall_scenario(robots=ONE, mission=with_victims((13.0, 5.0), (1.0, 5.0)))
    assert search_bound(resolve(scenario)) == pytest.approx((1.0 + 10.0) / SPEED_MPS)


def test_second_robot_shares_the_work(hall_scenario):
    robots = (*ONE, PlacedRobot(start_pose=(17.0, 5.0, 0.0)))
    scenario = hall_scenario(robots=robots, mission=with_victims((5.0, 5.0), (13.0, 5.0)))
    assert search_bound(resolve(scenario)) == pytest.approx(3.0 / SPEED_MPS)


def test_length_around_a_wall_is_below_the_exact_one_and_near_it(hall_scenario):
    plan = with_wall(hall_scenario().plan, 8.0)
    floor = OptimisticFloor(Building(plan), 0.2)
    ((length_m,),) = floor.lengths_m([(6.0, 3.0)], [(14.0, 3.0)], 0.0)[0]
    # Around the corners (9.9, 8) and (10.1, 8), whose clearance only makes the path longer.
    corners = [(6.0, 3.0), (9.9, 8.0), (10.1, 8.0), (14.0, 3.0)]
    exact_m = sum(math.dist(a, b) for a, b in pairwise(corners))
    assert 0.9 * OCTILE * exact_m < length_m <= exact_m + 0.2


def test_no_length_leads_through_a_wall_that_is_one_cell_wide():
    size_m = 60.0
    cell_m = math.sqrt(size_m**2 / 120_000)
    x_m = 172.5 * cell_m  # in the middle of a column of cells
    wall = {"name": "middle", "from": [x_m, 0.0], "to": [x_m, 50.0], "thickness_m": 0.01}
    plan = from_mapping(
        {
            "name": "hall",
            "plan": {"name": "hall", "bounds": {"max": [size_m, size_m]}, "walls": [wall]},
            "robots": [{"start_pose": [3.0, 5.0, 0.0]}],
        },
        "hall",
    ).plan
    floor = OptimisticFloor(Building(plan), 0.18)
    assert floor.cell_m == pytest.approx(cell_m)
    ((length_m,),) = floor.lengths_m([(x_m - 4.0, 30.0)], [(x_m + 4.0, 30.0)], 0.0)[0]
    exact_m = 2.0 * math.hypot(4.0, 20.0)  # around the end of the wall
    assert 0.9 * OCTILE * exact_m < length_m <= exact_m


def test_victim_behind_walls_takes_forever(hall_scenario):
    plan = with_wall(hall_scenario().plan, 10.0)
    bound_s = search_bound(resolve(hall_scenario(plan=plan, robots=ONE, mission=with_victims((14.0, 5.0), (5.0, 5.0)))))
    assert bound_s == math.inf


def test_victim_just_behind_a_wall_is_saved_through_it(hall_scenario):
    plan = with_wall(hall_scenario().plan, 10.0)
    bound_s = search_bound(resolve(hall_scenario(plan=plan, robots=ONE, mission=with_victims((10.4, 5.0)))))
    assert bound_s == pytest.approx((10.4 - 3.0 - 1.0) / SPEED_MPS)


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
        bound_s = search_bound(resolve(seeded))
        saved = [victim["saved_s"] for victim in json.loads(outcome.details)["victims"].values()]
        if None not in saved:
            solved += 1
            assert bound_s <= max(saved)
    assert solved >= 2


ROOMS = {
    "name": "rooms",
    "bounds": {"max": [60, 10]},
    "walls": [
        {"name": "south", "from": [0, 0], "to": [60, 0]},
        {"name": "north", "from": [0, 10], "to": [60, 10]},
        {"name": "west", "from": [0, 0], "to": [0, 10]},
        {"name": "east", "from": [60, 0], "to": [60, 10]},
        {"name": "left", "from": [0, 5], "to": [3, 5]},
        {"name": "right", "from": [4.2, 5], "to": [58, 5]},
    ],
}
"""Two rooms with a closed door at x = 3 m between them, and a gap at the other end, 54 m away."""

BOXES = {"name": "boxes", "polygon": [[3, 3.5], [4.2, 3.5], [4.2, 5], [3, 5]], "growth": "ultra_fast", "load_mj_m2": 1}
FIRE = {
    "fuel": [BOXES],
    "ignitions": [{"position": [3.6, 4.75]}],
    "heat": {"door_endures_s": 0.0, "robot_limit_c": 2000.0, "block_c": 2000.0},
}


def rooms(fire: dict[str, object] | None, **door: object) -> Scenario:
    """A robot on one side of the door, a victim on the other."""
    return from_mapping(
        {
            "name": "rooms",
            "plan": {**ROOMS, "doors": [{"name": "door", "from": [3, 5], "to": [4.2, 5], "closed": True, **door}]},
            "robots": [{"start_pose": [2.0, 2.0, 0.0]}],
            "fire": fire,
            "mission": {
                "areas": [{"name": "far", "center": [50, 8]}],
                "victims": [{"name": "ann", "position": [3.6, 8.0]}],
                "time_limit_s": 300.0,
            },
            "control": {"algorithm": "search"},
        },
        "rooms",
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fire", "door", "is_open"),
    [
        (FIRE, {}, True),
        (FIRE, {"motion": "swing"}, True),
        (FIRE, {"kind": "fireproof"}, False),
        ({**FIRE, "fireproof": ["door"]}, {}, False),
        (None, {}, False),
    ],
)
def test_bound_has_no_closed_doors_that_a_fire_may_open(fire, door, is_open):
    time_s = search_bound(resolve(rooms(fire, **door)))
    if is_open:
        assert time_s == pytest.approx((math.dist((2.0, 2.0), (3.6, 8.0)) - 1.0) / SPEED_MPS)
    else:
        assert time_s > 100.0 / SPEED_MPS


@pytest.mark.slow
def test_no_mission_through_a_burnt_door_is_faster_than_its_bound():
    scenario = rooms(FIRE)
    outcome = run_trial(scenario, Trial(0, 1, 0), __version__)
    saved_s = json.loads(outcome.details)["victims"]["ann"]["saved_s"]
    assert search_bound(resolve(scenario)) <= saved_s < 100.0 / SPEED_MPS


@pytest.mark.parametrize("moves", [{"wander": {"center": (9.0, 4.0), "radius_m": 2.0}}, {"flees": True}])
def test_victims_who_move_are_rejected_because_they_would_break_the_bound(hall_scenario, moves):
    mission = {
        "victims": [{"name": "ann", "position": (9.0, 4.0), **moves}],
        "exits": [{"name": "door", "center": (3.0, 5.0)}],
    }
    with pytest.raises(CampaignError, match=r"hall: mission\.victims: the bound assumes that nobody walks"):
        search_bound(resolve(hall_scenario(mission=Mission(**mission))))


def test_schedule_is_rejected_because_it_would_break_the_bound(hall_scenario):
    event = ScheduledEvent(at_s=5.0, noise_db=20.0)
    with pytest.raises(CampaignError, match="hall: schedule: not allowed: the bound assumes that nothing is changed"):
        search_bound(resolve(hall_scenario(schedule=(event,))))
