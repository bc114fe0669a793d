"""docs/own_building.md, literally as printed: from the drawing to a mission, without ROS."""

from __future__ import annotations

import json
import re
import runpy
import subprocess
from pathlib import Path

import pytest

from robotteamsim.scenario import load_floor_plan, occupancy_grid
from robotteamsim.scenario.plan import FREE

pytestmark = pytest.mark.slow

MAKE = runpy.run_path(str(Path(__file__).parents[3] / "docs" / "make_own_building.py"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The reader's folder after all commands of the page that need no ROS."""
    path = tmp_path_factory.mktemp("own")
    MAKE["prepare"](path)
    for command in MAKE["commands"]():
        command += " --out results" if " run " in command else ""
        done = subprocess.run(command, shell=True, cwd=path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return path


def test_page_has_a_picture_of_every_step_and_one_command_for_ros():
    text = MAKE["PAGE"].read_text()
    for name in ("drawing", *MAKE["PICTURES"]):
        assert f"(images/own_building_{name}.png)" in text
    assert len(MAKE["commands"]()) == 7
    assert text.count("\nroslaunch ") == 1


def test_imported_plan_has_the_walls_and_gaps_of_the_drawing(folder: Path):
    grid = occupancy_grid(load_floor_plan(folder / "plan.yaml"), 0.05)
    for start, end in (*MAKE["OUTER"], *MAKE["INNER"]):
        middle = [(a + b) / 2.0 for a, b in zip(start, end, strict=True)]
        assert grid.cells[grid.cell_at(*middle)] != FREE
    for x_m, y_m in ((2.95, 5.8), (7.55, 5.8), (11.45, 5.8), (3.55, 4.2), (9.55, 4.2)):
        assert grid.cells[grid.cell_at(x_m, y_m)] == FREE


def test_door_of_the_page_fits_into_the_imported_plan(folder: Path):
    (doors,) = re.findall(r"`(doors: \[.*?\])`", MAKE["PAGE"].read_text())
    plan = folder / "with_door.yaml"
    plan.write_text((folder / "plan.yaml").read_text() + doors)
    assert [door.name for door in load_floor_plan(plan).doors] == ["kitchen"]


def test_commands_write_their_pictures_and_the_mission_saves_both_victims(folder: Path):
    for name in MAKE["PICTURES"]:
        assert (folder / f"{name}.png").stat().st_size > 10_000
    result = json.loads((folder / "results" / "mission.json").read_text())["result"]
    assert (result["end"], result["victims_saved"]) == ("areas_explored", 2)
