"""The shipped maps and scenarios, and the scenarios in real buildings."""

from __future__ import annotations

import runpy
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy import ndimage

from robotteamsim.scenario import load, load_floor_plan, map_names, occupancy_grid, scenario_names
from robotteamsim.scenario.map_image import import_map
from robotteamsim.scenario.plan import FREE
from robotteamsim.scenario.shipped import shipped_plan
from robotteamsim.setup import resolve

BUILDINGS = sorted((Path(__file__).parents[2] / "data" / "scenarios").glob("*.yaml"))
SCENARIOS = [*scenario_names(), *BUILDINGS]
MARGIN_M = 0.1
EXPORT = "bench/import_accuracy_bench.py"
export_map = runpy.run_path(str(Path(__file__).parents[3] / EXPORT))["export_map"]


def _name(scenario: str | Path) -> str:
    return Path(scenario).stem


@pytest.mark.parametrize("name", map_names())
def test_shipped_image_equals_the_export_of_the_plan(name: str, tmp_path: Path) -> None:
    export_map(load_floor_plan(name), tmp_path)
    folder = shipped_plan(name).parent
    assert (folder / "map.yaml").read_bytes() == (tmp_path / "map.yaml").read_bytes()
    assert (folder / "map.pgm").read_bytes() == (tmp_path / "map.pgm").read_bytes(), (
        f"run export_map of {EXPORT} for maps/{name}"
    )
    assert (folder / "SOURCE.md").is_file()


@pytest.mark.parametrize("name", map_names())
def test_shipped_plan_is_closed_by_outer_walls(name: str) -> None:
    cells = occupancy_grid(load_floor_plan(name), 0.05).cells
    border = np.concatenate([cells[0], cells[-1], cells[:, 0], cells[:, -1]])
    assert np.all(border != FREE)


def test_exported_image_is_read_by_others_as_the_grid(tmp_path: Path) -> None:
    plan = load_floor_plan("tutorial_arena")
    export_map(plan, tmp_path)
    image = cv2.imread(str(tmp_path / "map.pgm"), cv2.IMREAD_UNCHANGED)
    np.testing.assert_array_equal(np.flipud(image) == 254, occupancy_grid(plan, 0.05).cells == FREE)


@pytest.mark.slow
@pytest.mark.parametrize("name", map_names())
def test_exported_image_is_imported_with_the_same_cells(name: str) -> None:
    plan = load_floor_plan(name)
    imported = import_map(shipped_plan(name).parent / "map.yaml")
    assert imported.bounds == plan.bounds
    differ = occupancy_grid(imported, 0.05).cells != occupancy_grid(plan, 0.05).cells
    assert np.count_nonzero(differ) == 0


@pytest.mark.slow
@pytest.mark.parametrize("scenario", SCENARIOS, ids=_name)
def test_robots_can_reach_every_area_and_victim(scenario: str | Path) -> None:
    """By a flood fill from robot 0 where it keeps a margin from solids; all others start in that region too.

    The regions at the stops of a passage are one. Without robots, people can reach every exit, and are the victims.
    """
    setup = resolve(load(scenario))
    loaded, robots = setup.scenario, setup.robots
    grid = occupancy_grid(loaded.plan, 0.05)
    clearance_m = 0.05 * ndimage.distance_transform_edt(grid.cells == FREE)
    labels, _ = ndimage.label(clearance_m > (robots[0].radius_m if robots else loaded.people.radius_m) + MARGIN_M)
    for stops in (passage.stops for passage in loaded.plan.passages if passage.takes("robots")):
        joined = {int(labels[grid.cell_at(*stop)]) for stop in stops}
        assert 0 not in joined
        labels[np.isin(labels, list(joined))] = min(joined)
    starts_m = [robot.start_pose[:2] for robot in robots] or [way_out.center for way_out in loaded.mission.exits]
    starts = {int(labels[grid.cell_at(*start_m)]) for start_m in starts_m}
    assert len(starts) == 1
    assert starts != {0}
    rows, columns = np.nonzero(labels == starts.pop())
    centres = np.array([grid.cell_center(0, 0)]) + 0.05 * np.stack([columns, rows], axis=1)
    spots = [(area.name, area.center, area.radius_m) for area in loaded.mission.areas]
    spots += [(v.name, v.position, loaded.mission.save_distance_m) for v in loaded.mission.victims]
    assert spots
    for name, position, radius_m in spots:
        assert np.min(np.linalg.norm(centres - position, axis=1)) < 0.5 * radius_m, name


def test_garage_keeps_the_route_and_the_victims_of_the_study() -> None:
    scenario = load("garage_sar")
    assert [area.center for area in scenario.mission.areas] == [
        (18.0, 7.0), (40.0, 7.0), (56.0, 10.5), (53.0, 33.8), (13.8, 35.4),
    ]  # fmt: skip
    assert [victim.position for victim in scenario.mission.victims] == [
        (29.0, 4.5), (56.5, 22.0), (35.0, 22.7), (20.5, 23.7),
    ]  # fmt: skip
    assert {area.radius_m for area in scenario.mission.areas} == {2.0}
    assert len(resolve(scenario).robots) == 3
