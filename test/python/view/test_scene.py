"""The scene contains what the scenario contains; grids become rectangles that cover the same cells."""

from __future__ import annotations

import hypothesis.extra.numpy as arrays
import numpy as np
from hypothesis import given

from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.view.scene import rectangles, scene_of


@given(arrays.arrays(np.bool_, arrays.array_shapes(min_dims=2, max_dims=2, max_side=12)))
def test_rectangles_cover_each_occupied_cell_once(occupied: np.ndarray) -> None:
    covered = np.zeros(occupied.shape, dtype=int)
    for left, right, bottom, top in rectangles(occupied):
        covered[bottom:top, left:right] += 1
    assert np.array_equal(covered, occupied.astype(int))


def test_a_filled_block_is_one_rectangle() -> None:
    cells = np.zeros((5, 6), dtype=bool)
    cells[1:4, 2:5] = True
    assert list(rectangles(cells)) == [(2, 5, 1, 4)]


def test_scene_has_every_wall_door_area_and_robot_of_the_scenario() -> None:
    scenario = load("garage_sar", ["robots.count=4"])
    scene = scene_of(resolve(scenario))
    assert len(scene.solids) == len(scenario.plan.walls) + len(scenario.plan.blocks)
    assert [door.name for door in scene.doors] == [door.name for door in scenario.plan.doors]
    assert [area.center_m for area in scene.areas] == [area.center for area in scenario.mission.areas]
    assert len(scene.robots) == 4
    assert len({robot.colour for robot in scene.robots}) == 4
