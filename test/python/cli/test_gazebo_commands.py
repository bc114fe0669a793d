"""`plan export-gazebo` and `plan import-gazebo`."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.cli import main
from robotteamsim.scenario import load, load_floor_plan

BOX = "<geometry><box><size>4 0.2 1</size></box></geometry>"
MESH = "<geometry><mesh><uri>a.dae</uri></mesh></geometry>"
SHELF = f'<model name="shelf"><static>1</static><link name="l"><collision name="c">{BOX}</collision></link></model>'
WORLD = f'<sdf version="1.6"><world name="w">{SHELF}<include><uri>model://case</uri></include></world></sdf>'


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))


def _write_models(folder: str, shape: str = BOX) -> None:
    place = Path(folder, "case")
    place.mkdir(parents=True)
    model = SHELF.replace("shelf", "case").replace(BOX, shape)
    (place / "model.sdf").write_text(f'<sdf version="1.6">{model}</sdf>')


def test_exported_garage_is_imported_again(capsys):
    assert main(["plan", "export-gazebo", "garage_sar", "--out", "out", "--set", "robots.reserve=1"]) == 0
    captured = capsys.readouterr()
    assert captured.out == "out/garage_sar.world: 2 robots, 2 doors\n"
    assert captured.err.startswith("robotteamsim: warning: robots: those that arrive later have a file each")
    assert sorted(path.name for path in Path("out").iterdir()) == ["garage_sar.world", "robot_2.sdf"]
    assert main(["plan", "import-gazebo", "out/garage_sar.world"]) == 0
    captured = capsys.readouterr()
    assert captured.out == "plan.yaml: 16 walls, 23 blocks, 2 doors\n"
    warning = "out/garage_sar.world: omitted, because they are not static: robot_0, robot_1"
    assert captured.err == f"robotteamsim: warning: {warning}\n"
    assert load("garage_sar", ["plan=plan.yaml"]).plan.doors == load("garage_sar").plan.doors


def test_included_models_are_found_in_folders_and_the_environment(capsys, monkeypatch):
    Path("a.world").write_text(WORLD)
    _write_models("here")
    assert main(["plan", "import-gazebo", "a.world", "--models", "here", "--out", "one.yaml"]) == 0
    monkeypatch.setenv("GAZEBO_MODEL_PATH", "/nowhere:here")
    assert main(["plan", "import-gazebo", "a.world", "--out", "two.yaml"]) == 0
    assert capsys.readouterr().err == ""
    for file in ("one.yaml", "two.yaml"):
        assert [wall.name for wall in load_floor_plan(file).walls] == ["shelf", "case"]


def test_mesh_is_a_warning_or_with_strict_an_error(capsys, refusal):
    Path("a.world").write_text(WORLD)
    _write_models("here", MESH)
    line = "here/case/model.sdf:1: collision 'c': in 'case': a mesh 'a.dae' cannot become a wall"
    assert refusal("plan", "import-gazebo", "a.world", "--models", "here", "--strict") == line
    assert not Path("plan.yaml").exists()
    assert main(["plan", "import-gazebo", "a.world", "--models", "here"]) == 0
    assert capsys.readouterr().err == f"robotteamsim: warning: {line}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["import-gazebo", "no.world"], "no.world: there is no such file"),
        (["import-gazebo", "a.world", "--models", "nowhere"], "--models nowhere: there is no such folder"),
        (["import-gazebo", "a.world", "--out", "a.world"], "--out a.world: would overwrite the world"),
        (["export-gazebo", "garage_sra", "--out", "out"], "garage_sra: no shipped scenario of this name"),
        (["export-gazebo", "garage_sar"], "the following arguments are required: --out"),
        (
            ["export-gazebo", "garage_sar", "--out", "out", "--drive", "legs"],
            "--drive: 'legs' is not valid; expected one of velocity, wheels",
        ),
    ],
)
def test_bad_command_is_refused_and_leaves_nothing_behind(refusal, arguments, message):
    Path("a.world").write_text(WORLD)
    assert refusal("plan", *arguments).startswith(message)
    assert [path.name for path in Path().iterdir()] == ["a.world"]


def test_existing_plan_is_kept_unless_it_is_named(refusal):
    Path("a.world").write_text(WORLD)
    Path("plan.yaml").write_text("mine")
    assert refusal("plan", "import-gazebo", "a.world") == "plan.yaml already exists; choose a file with --out"
    assert Path("plan.yaml").read_text() == "mine"
