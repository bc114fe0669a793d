"""`robotteamsim new` writes files that work as they are."""

from __future__ import annotations

import argparse
import os
import sys
import tomllib
from pathlib import Path
from xml.etree.ElementTree import parse

import pytest

from robotteamsim.cli import main, new_command
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.slow
def test_new_scenario_is_a_mission_that_ends_well(capsys):
    assert main(["new", "scenario", "house"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "house.yaml",
        "house_plan.yaml",
        "next: robotteamsim run house.yaml",
    ]
    with pytest.raises(SystemExit):
        main(["scenario", "schema", "--help"])
    first, *_ = Path("house.yaml").read_text().splitlines()
    assert first.startswith("# yaml-language-server: $schema=")
    assert capsys.readouterr().out.endswith(f"{first}\n")
    loaded = load("house.yaml")
    assert (loaded.name, loaded.plan.name) == ("house", "house")
    result = Simulation(loaded).run()
    assert (result.end, result.areas_explored, result.victims_saved) == ("areas_explored", 2, 1)


def test_new_controller_runs(capsys, monkeypatch, tmp_path):
    assert main(["new", "controller", "wall_walker_of_test"]) == 0
    assert "control.algorithm=wall_walker_of_test:WallWalkerOfTest" in capsys.readouterr().out
    monkeypatch.syspath_prepend(tmp_path)
    overrides = ["control.algorithm=wall_walker_of_test:WallWalkerOfTest", "mission.time_limit_s=2"]
    simulation = Simulation(load("tutorial_arena", overrides))
    assert not any(decision.fault for decision in simulation.step().decisions)
    sys.modules.pop("wall_walker_of_test")


@pytest.mark.parametrize(
    ("kind", "wanted"),
    [
        ("scenario", ["scenario.yaml", "scenario_plan.yaml"]),
        ("controller", ["controller.py"]),
        ("package", ["package"]),
        ("exercises", ["exercises"]),
        ("layout", ["layout.json"]),
    ],
)
def test_name_is_that_of_the_kind_if_none_is_given(capsys, refusal, kind, wanted):
    assert main(["new", kind]) == 0
    capsys.readouterr()
    assert sorted(os.listdir()) == wanted
    assert refusal("new", kind) == f"{wanted[0]}: exists already; expected a new name"


@pytest.mark.parametrize(
    ("name", "title"), [("wall_walker", "WallWalker"), ("my_controller_of_test", "MyControllerOfTest")]
)
def test_new_package_registers_its_controller_by_name(name, title):
    assert main(["new", "package", name]) == 0
    project = tomllib.loads(Path(name, "pyproject.toml").read_text())["project"]
    assert project["name"] == name.replace("_", "-")
    assert project["entry-points"]["robotteamsim.controllers"] == {name: f"{name}:{title}"}
    assert os.listdir() == [name]
    assert f"class {title}" in Path(name, f"{name}.py").read_text()


def test_new_package_is_a_catkin_package_too():
    """test/ros/test_templates.py builds and starts it."""
    assert main(["new", "package", "wall_walker"]) == 0
    files = {str(path.relative_to("wall_walker")) for path in Path("wall_walker").rglob("*") if path.is_file()}
    assert files == {
        "pyproject.toml",
        "wall_walker.py",
        "package.xml",
        "CMakeLists.txt",
        "my_node.py",
        "launch/wall_walker.launch",
    }
    assert parse(Path("wall_walker", "package.xml")).findtext("name") == "wall_walker"
    assert os.access(Path("wall_walker", "my_node.py"), os.X_OK)


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ("scenario", "../x"),
            "NAME: '../x' is not valid; expected at most 64 lower-case letters, digits and _, such as my_house",
        ),
        (("scenario", ""), "NAME: '' is not valid"),
        (("scenario", "a" * 65), "NAME: 'aaaaaaaa"),
        (
            ("scenario", "garage_sar"),  # `run garage_sar` would run the shipped one
            "NAME: 'garage_sar' is the name of something else in Python or robotteamsim; expected a new name, such as "
            "my_garage_sar",
        ),
        (("scenario", "true"), "NAME: 'true' is not text in YAML; expected another name"),
        (("controller", "json"), "NAME: 'json' is the name of something else in Python or robotteamsim"),
        (("controller", "numpy"), "NAME: 'numpy' is the name of something else in Python or robotteamsim"),
        (("controller", "none"), "NAME: 'none' is the name of something else in Python or robotteamsim"),
        (("package", "rdpso"), "NAME: 'rdpso' is the name of something else in Python or robotteamsim"),
        (("scenario", "there"), "there_plan.yaml: exists already; expected a new name"),
    ],
)
def test_wrong_name_is_rejected_and_nothing_is_written(refusal, arguments, line):
    Path("there_plan.yaml").touch()
    assert refusal("new", *arguments).startswith(line)
    assert os.listdir() == ["there_plan.yaml"]


def test_interrupted_command_leaves_nothing(monkeypatch):
    written = []

    def interrupted(path, text):
        if written:
            raise KeyboardInterrupt
        written.append(path)
        path.write_text(text)

    monkeypatch.setattr(new_command, "write_atomically", interrupted)
    with pytest.raises(KeyboardInterrupt):
        new_command.run(argparse.Namespace(kind="package", name="wall_walker"))
    assert len(written) == 1
    assert os.listdir() == []
