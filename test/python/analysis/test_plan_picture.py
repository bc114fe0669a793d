"""Pictures of floor plans."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from matplotlib.collections import PatchCollection

from robotteamsim.analysis.plan_picture import draw_plan
from robotteamsim.scenario import load, load_floor_plan
from robotteamsim.scenario.plan import plan_of_level
from robotteamsim.setup import resolve


def test_plan_is_drawn_to_scale_with_its_size_in_the_title() -> None:
    axes = draw_plan(load_floor_plan("garage")).axes[0]
    assert axes.get_title() == "garage, 60 x 40 m"
    assert axes.get_aspect() == 1.0


def test_level_is_drawn_alone() -> None:
    plan = load_floor_plan(str(Path(__file__).parents[2] / "data" / "maps" / "two_levels" / "plan.yaml"))
    texts = [
        {text.get_text() for text in draw_plan(shown).axes[0].texts}
        for shown in (plan, *(plan_of_level(plan, level) for level in plan.levels))
    ]
    assert texts == [
        {"L1 at 0 m", "L2 at 3 m", "lift", "ramp"},
        {"L1 at 0 m", "lift", "ramp"},
        {"L2 at 3 m", "lift", "ramp"},
    ]
    level = plan_of_level(plan, plan.levels[1])
    assert [wall.name for wall in level.walls] == ["south_2", "east_2", "north_2", "west_2", "middle_2"]
    assert (level.bounds.min, [passage.stops for passage in level.passages]) == (
        (15.0, 0.0),
        [((17.5, 7.5),), ((25.0, 2.0),)],
    )


def test_robots_with_corners_are_drawn_at_their_heading() -> None:
    corners = "[[-0.1, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.1, 0.2]]"
    scenario = load("tutorial_arena", [f"robots.footprint_m={corners}", "robots.spacing_m=2"])
    (robots,) = (
        item
        for item in draw_plan(scenario.plan, resolve(scenario)).axes[0].collections
        if isinstance(item, PatchCollection)
    )
    extents = robots.get_paths()[0].get_extents()
    assert (extents.x0, extents.x1, extents.y0, extents.y1) == pytest.approx((2.9, 3.5, 2.8, 3.2))


def test_scenario_adds_numbered_areas_named_victims_and_robots() -> None:
    scenario = load("garage_sar")
    axes = draw_plan(scenario.plan, resolve(scenario)).axes[0]
    texts = {text.get_text() for text in axes.texts}
    assert {"1", "2", "3", "4", "5", "victim_1", "victim_4"} <= texts
    (robots,) = (item for item in axes.collections if isinstance(item, PatchCollection))
    assert len(robots.get_paths()) == 3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["garage_sar", "tutorial_arena"])
def test_picture_shows_walls_and_floor(name: str, tmp_path: Path) -> None:
    scenario = load(name)
    draw_plan(scenario.plan, resolve(scenario)).savefig(tmp_path / "plan.png")
    grey = cv2.imread(str(tmp_path / "plan.png"), cv2.IMREAD_GRAYSCALE)
    assert min(grey.shape) > 800
    assert 0.02 < np.mean(grey < 110) < 0.4
    assert np.mean(grey > 230) > 0.5
