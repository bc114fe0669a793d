"""How a team that searches shares its last goals: who drives to the last area early, and who takes over a goal."""

from __future__ import annotations

import pytest

from robotteamsim.control.search.areas import NO_CELL, Areas
from robotteamsim.control.search.cells import cell_grid, cell_paths
from robotteamsim.control.search.last_area import EarlyDrive
from robotteamsim.control.search.team import Teammates
from robotteamsim.control.search.update import SearchUpdate
from robotteamsim.interface import Task
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
