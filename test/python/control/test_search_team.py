"""Goals of a searching team: who drives to the last area early or takes over a goal, where voices are looked for."""

from __future__ import annotations

import itertools

import pytest

from robotteamsim.control.search.areas import Areas
from robotteamsim.control.search.cells import NO_CELL, cell_grid, cell_paths, reachable_cell
from robotteamsim.control.search.last_area import EarlyDrive
from robotteamsim.control.search.team import Teammates
from robotteamsim.control.search.update import SearchUpdate
from robotteamsim.interface import Task
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.sections import Area, Mission

NEXT, LAST = (3.5, 5.5), (16.5, 5.5)


@pytest.fixture
def hall(hall_scenario):
    """The hall with an area at each end, its cells, and the paths between them."""
    listed = (Area(name="next", center=NEXT, radius_m=1.0), Area(name="last", center=LAST, radius_m=1.0))
    scenario = hall_scenario(mission=Mission(areas=listed))
    grid = cell_grid(scenario)
    return scenario, grid, cell_paths(scenario.plan, 0.2, grid, (), None)


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


def test_voice_in_a_cell_without_a_path_is_looked_for_from_the_nearest_cell_with_one(hall):
    scenario, grid, _ = hall
    corners = [(14.0, 3.0), (18.0, 3.0), (18.0, 7.0), (14.0, 7.0), (14.0, 3.0)]
    walls = [Wall(name=f"box_{i}", start=a, end=b) for i, (a, b) in enumerate(itertools.pairwise(corners))]
    plan = scenario.plan.model_copy(update={"walls": (*scenario.plan.walls, *walls)})
    paths, start = cell_paths(plan, 0.2, grid, (), None), grid.cell_of((2.5, 5.5))
    at_the_wall, beside, inside = (14.5, 5.5), (13.5, 5.5), (16.0, 5.0)
    assert reachable_cell(paths, grid, beside, start) == grid.cell_of(beside)
    assert reachable_cell(paths, grid, at_the_wall, start) == grid.cell_of(beside)
    assert reachable_cell(paths, grid, inside, start) == NO_CELL
    assert reachable_cell(paths, grid, beside, NO_CELL) == NO_CELL
