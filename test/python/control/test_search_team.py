"""Goals of a searching team: who drives to the last area early or takes over a goal, where voices are looked for."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
import shapely

from robotteamsim.campaign.protocol import SearchProtocol, search_design
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.search.areas import Areas, EarlyDrive
from robotteamsim.control.search.cells import NO_CELL, cell_grid, cell_paths, reachable_cell
from robotteamsim.control.search.goals import ListeningGoal
from robotteamsim.control.search.knowledge import Knowledge
from robotteamsim.control.search.team import SearchUpdate, Teammates
from robotteamsim.interface import Task
from robotteamsim.scenario import load
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.sections import Area, Mission, Run, Victim, Voice
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

CUMBERLAND = Path(__file__).parents[2] / "data" / "scenarios" / "cumberland.yaml"
NEXT, LAST = (3.5, 5.5), (16.5, 5.5)


@pytest.fixture
def hall(hall_scenario):
    """The hall with an area at each end, its cells, and the paths between them."""
    listed = (Area(name="next", center=NEXT, radius_m=1.0), Area(name="last", center=LAST, radius_m=1.0))
    scenario = hall_scenario(mission=Mission(areas=listed), control={"algorithm": "search"})
    grid = cell_grid(scenario)
    return scenario, grid, cell_paths(Building(scenario.plan), 0.2, grid, (), None)


def _update(robot_id: int, at: int, work: str, goal: int) -> SearchUpdate:
    return SearchUpdate(robot_id, (0.0, 0.0), at, work, goal, None, None, 0.0, (), "")


def test_nearest_free_robot_drives_to_the_last_area_if_the_team_would_wait_for_it(hall):
    scenario, grid, paths = hall
    explorer, near, far = (grid.cell_of((x_m, 5.5)) for x_m in (2.5, 7.5, 6.5))
    areas = Areas(scenario, grid)
    areas.follow(Task(area_center_m=NEXT, area_radius_m=1.0))
    areas.measure(paths, explorer)
    team = Teammates(robot_id=2, given_up_s=30.0)
    team.hear(_update(0, explorer, "area", areas.cell), 0.0)
    assert EarlyDrive().is_needed(areas, team, paths, near, search_m=1.0)
    # The search takes longer than the path to the last area.
    assert not EarlyDrive().is_needed(areas, team, paths, near, search_m=10.0)
    team.hear(_update(1, near, "search", NO_CELL), 0.0)
    assert not EarlyDrive().is_needed(areas, team, paths, far, search_m=1.0)


def test_robot_without_work_ignores_a_claim_to_which_it_has_a_much_shorter_path(hall):
    _, grid, paths = hall
    goal, claimer = grid.cell_of((15.5, 5.5)), grid.cell_of((2.5, 5.5))
    team = Teammates(robot_id=1, given_up_s=30.0)
    team.hear(_update(0, claimer, "search", goal), 0.0)
    assert team.kept_claims(grid.cell_of((10.5, 5.5)), paths) == []
    assert team.kept_claims(grid.cell_of((3.5, 5.5)), paths) == team.claims == [goal]


@pytest.mark.parametrize("radius_m", [0.1, 1.0, 2.3])
def test_paths_of_a_known_map_keep_out_of_a_disc_to_a_cell(hall, radius_m):
    scenario, *_ = hall
    center = (10.0, 5.0)
    grid = known_map(Building(scenario.plan), 0.2, kept_out=(center, radius_m)).grid
    corners = grid.waypoints((5.0, 5.0), (15.0, 5.0), 100.0)
    assert not grid.is_line_free((5.0, 5.0), (15.0, 5.0))
    lines = [shapely.LineString(line) for line in itertools.pairwise(corners)]
    nearest_m = min(line.distance(shapely.Point(center)) for line in lines)
    # At least a body's clearance; of large discs, the rim.
    assert nearest_m == pytest.approx(max(radius_m, 0.25), abs=0.15)


def test_robot_without_work_takes_a_place_as_soon_as_a_teammate_leaves_it(hall):
    scenario, grid, paths = hall
    knowledge = Knowledge(resolve(scenario), 0, grid, grid.cell_of((2.5, 5.5)))
    goal, place = ListeningGoal(scenario.control, speed_mps=0.5), grid.cell_of((10.5, 5.5))

    def choose(claims, time_s):
        start = grid.cell_of((2.5, 5.5))
        return goal.choose(knowledge.belief, paths, start, [place], claims, claims, 1e-4, time_s)

    assert choose([place], 0.0) == NO_CELL
    # Long before the next regular choice: meanwhile the team might end the search.
    assert choose([], 0.1) == place


@pytest.mark.slow
def test_goal_of_a_teammate_who_is_out_of_contact_is_not_left_unsearched():
    # Two victims are 1.6 m apart, and nobody else took over the goal of a teammate who was not heard any more.
    protocol = SearchProtocol(("search",), ("office",), (30.0,), (3,), trials=2, seed=7, areas=False)
    design = search_design(protocol)
    *_, trial = design.all_trials()
    simulation = Simulation(design.cells[0].scenario.model_copy(update={"run": Run(seed=trial.seed)}))
    simulation.run()
    assert simulation.mission.status.victims_saved == 4


def test_voice_in_a_cell_without_a_path_is_looked_for_from_the_nearest_cell_with_one(hall):
    scenario, grid, _ = hall
    plan = scenario.plan.model_copy(update={"walls": (*scenario.plan.walls, *_box())})
    paths, start = cell_paths(Building(plan), 0.2, grid, (), None), grid.cell_of((2.5, 5.5))

    def cell_for(source_m, start=start):
        return reachable_cell(paths, grid, source_m, start, save_distance_m=1.0)

    at_the_wall, beside, inside = (14.5, 5.5), (13.5, 5.5), (15.5, 5.5)
    assert cell_for(beside) == cell_for(at_the_wall) == grid.cell_of(beside)
    assert cell_for(inside) == cell_for(beside, start=NO_CELL) == NO_CELL


def _box():
    corners = [(14.0, 3.0), (18.0, 3.0), (18.0, 7.0), (14.0, 7.0), (14.0, 3.0)]
    return [Wall(name=f"box_{i}", start=a, end=b) for i, (a, b) in enumerate(itertools.pairwise(corners))]


@pytest.mark.parametrize(("x_m", "saved"), [(14.5, 1), (15.2, 0), (15.5, 0)])
def test_victim_in_a_closed_room_is_saved_if_near_its_wall_and_else_does_not_hold_up_the_end(hall_scenario, x_m, saved):
    hall = hall_scenario().plan
    plan = hall.model_copy(update={"walls": (*hall.walls, *_box())})
    mission = Mission(victims=(Victim(name="eve", position=(x_m, 5.0)),), time_limit_s=600.0)
    scenario = hall_scenario(mission=mission, control={"algorithm": "search"}, voice=Voice(noise_db=40.0))
    simulation = Simulation(scenario.model_copy(update={"plan": plan}))
    result = simulation.run()
    status = simulation.mission.status
    assert (status.end, status.victims_saved) == ("search_over", saved)
    assert result.time_s < 200.0


@pytest.mark.slow
def test_victim_next_to_a_cell_too_tight_for_a_robot_is_saved():
    settings = ["control.algorithm=search", "voice.noise_db=30", "mission.random_victims=4", "mission.victims=[]"]
    simulation = Simulation(load(str(CUMBERLAND), [*settings, "run.seed=4682939054865940"]))
    simulation.run()
    assert simulation.mission.status.victims_saved == 4
