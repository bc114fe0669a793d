"""Victims at random places: reachable, uniform, the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import load
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Mission, PlacedRobot, Run
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation
from robotteamsim.world.random_victims import reachable_cells_m


def places(scenario) -> list[tuple[float, float]]:
    return [victim.position for victim in resolve(scenario).scenario.mission.victims]


def test_places_depend_on_the_seed_alone():
    first = load("garage_sar", ["mission.victims=[]", "mission.random_victims=5"])
    other = load("garage_sar", ["mission.victims=[]", "mission.random_victims=5", "run.seed=2"])
    changed = load(
        "garage_sar",
        [
            "mission.victims=[]",
            "mission.random_victims=5",
            "robots.count=8",
            "control.algorithm=sebs",
            "voice.noise_db=30",
        ],
    )
    assert places(first) == places(changed) != places(other)
    assert len(set(places(first))) == 5


def test_no_victim_is_in_a_wall_or_behind_one_that_has_no_door(hall_scenario):
    hall = hall_scenario().plan
    wall = Wall(name="middle", start=(10.0, 0.0), end=(10.0, 10.0))
    plan = hall.model_copy(update={"walls": (*hall.walls, wall)})
    scenario = hall_scenario(plan=plan, mission=Mission(random_victims=200))
    at = np.array(places(scenario))
    assert at[:, 0].max() < 10.0
    assert shapely.distance(obstacles(plan), shapely.points(at)).min() >= 0.2


def test_victims_are_spread_uniformly(hall_scenario):
    counts = np.zeros(4)
    for seed in range(40):
        scenario = hall_scenario(mission=Mission(random_victims=100), run=Run(seed=seed))
        counts += np.histogram([x for x, _ in places(scenario)], bins=4, range=(0.5, 19.5))[0]
    # 4000 victims in four equal parts: 1000 in each, standard deviation 27.
    assert np.abs(counts - 1000.0).max() < 110.0


def test_cells_are_the_floor_less_the_clearance(hall_scenario):
    cells_m = reachable_cells_m(Building(hall_scenario().plan), 0.2, ((3.0, 4.0),), "robots")
    # Walls of 0.2 m; cells whose centres are nearer to them than 0.25 m are two more rows and columns on each side.
    assert len(cells_m) == (196 - 4) * (96 - 4)


def test_own_victims_stay_and_the_simulation_saves_them_all(hall_scenario):
    mission = hall_scenario().mission.model_copy(update={"random_victims": 3})
    simulation = Simulation(hall_scenario(mission=mission))
    assert [victim.name for victim in simulation.mission.victims] == ["ann", "bob", "random_1", "random_2", "random_3"]
    assert simulation.scenario.mission.random_victims == 0


def test_plan_without_a_reachable_free_cell_is_rejected_in_one_line(hall_scenario, closet):
    robots = (PlacedRobot(start_pose=(0.28, 0.28, 0.0), radius_m=0.15),)
    scenario = hall_scenario(plan=closet, robots=robots, mission=Mission(random_victims=1))
    with pytest.raises(ScenarioError, match=r"mission.random_victims: 1 victims, but robots can reach 0 free cells"):
        Simulation(scenario)


def test_name_of_a_random_victim_is_rejected_for_another():
    with pytest.raises(ScenarioError, match=r"mission.victims.0.name: 'random_1' is the name of a victim of random_vi"):
        load("garage_sar", ["mission.victims.0.name=random_1", "mission.random_victims=2"])
