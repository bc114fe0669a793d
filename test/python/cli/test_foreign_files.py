"""A file of another simulator is named as what it is, whatever command it was given to."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.cli import main

SDF = '<?xml version="1.0"?>\n<!-- a world -->\n<sdf version="1.6">\n  <world name="w"/>\n</sdf>\n'
MVSIM = (
    '<mvsim_world version="1.0">\n  <element class="occupancy_grid"><file>map.png</file></element>\n</mvsim_world>\n'
)
IR_SIM = "world:\n  height: 10\n  width: 10\nrobot:\n  kinematics: {name: diff}\n"
RMF = "coordinate_system: reference_image\ncrowd_sim: {enable: 0}\nlevels:\n  L1: {elevation: 0}\nname: office\n"
STAGE = "# a world\nmodel\n(\n  size [ 10 10 1 ] noblocks 1 boundary 1\n)\nposition( pose [ 0 0 0 0 ] )\n"

NO_COMMAND = "which no command reads; docs/own_building.md shows how to draw its floor plan"


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", ["run", "plan import", "plan render --png p.png", "analyse", "view"])
@pytest.mark.parametrize(
    ("text", "what"),
    [
        (SDF, "a world of Gazebo (SDF)"),
        (MVSIM, "a world of MVSim"),
        (IR_SIM, "a world of IR-SIM"),
    ],
)
def test_file_that_no_command_reads_is_named(refusal, command, text, what):
    Path("a.world").write_text(text)
    assert refusal(*command.split(), "a.world") == f"a.world is {what}, {NO_COMMAND}"


@pytest.mark.parametrize("command", ["run", "plan export-stage --out o", "analyse"])
@pytest.mark.parametrize(("text", "what"), [(STAGE, "a world of Stage"), (RMF, "a building.yaml of Open-RMF")])
def test_file_that_can_be_imported_is_named_with_the_command_that_reads_it(refusal, command, text, what):
    Path("a.world").write_text(text)
    assert refusal(*command.split(), "a.world") == f"a.world is {what}: use plan import"


def test_stage_world_that_import_rejects_is_rejected_as_before(refusal):
    Path("a.world").write_text(STAGE + "puck()")
    assert refusal("plan", "import", "a.world") == "a.world:7: puck: unknown model 'puck'"


def test_mistake_in_a_file_of_ours_is_reported_as_before(refusal):
    Path("s.yaml").write_text("name: s\nplan: office\nrobots: {count: 1, start: [2, 2, 0]}\nworld: 3\n")
    assert "unknown key" in refusal("run", "s.yaml")
    levels = "levels: [{name: L1, bounds: {min: [0, 0], max: [9, 9]}, elevation_m: 0}]"
    Path("l.yaml").write_text(f"name: l\nbounds: {{min: [0, 0], max: [9, 9]}}\n{levels}\n")
    no_level = "--level: l.yaml has no level 'L2'; known: L1"
    assert refusal("plan", "render", "l.yaml", "--level", "L2", "--png", "p.png") == no_level
    Path("p.yaml").write_text("name: p\nbounds: {min: [0, 0], max: [9, 9]}\n")
    assert main(["plan", "render", "p.yaml", "--png", "p.png"]) == 0
