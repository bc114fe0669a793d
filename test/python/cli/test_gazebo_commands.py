"""`plan export-gazebo`."""

from __future__ import annotations

from pathlib import Path

import pytest

from robotteamsim.cli import main


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_exported_garage_is_a_world_and_a_file_for_each_robot_that_comes_later(capsys):
    assert main(["plan", "export-gazebo", "garage_sar", "--out", "out", "--set", "robots.reserve=1"]) == 0
    captured = capsys.readouterr()
    assert captured.out == "out/garage_sar.world: 2 robots, 2 doors\n"
    assert captured.err.startswith("robotteamsim: warning: robots: those that arrive later have a file each")
    assert sorted(path.name for path in Path("out").iterdir()) == ["garage_sar.world", "robot_2.sdf"]


@pytest.mark.parametrize("name", ["garage_sar.world", "robot_2.sdf"])
def test_no_file_is_replaced_without_force(refusal, name):
    Path("out").mkdir()
    Path("out", name).write_text("mine")
    command = ["plan", "export-gazebo", "garage_sar", "--out", "out", "--set", "robots.reserve=1"]
    line = refusal(*command)
    assert line == f"out/{name} already exists; choose another name with --out, or --force replaces it"
    assert [path.read_text() for path in Path("out").iterdir()] == ["mine"]
    assert main([*command, "--force"]) == 0
    assert Path("out", name).read_text() != "mine"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["garage_sra", "--out", "out"], "garage_sra: no shipped scenario of this name"),
        (["garage_sar"], "the following arguments are required: --out"),
        (
            ["garage_sar", "--out", "out", "--drive", "legs"],
            "--drive: 'legs' is not valid; expected one of velocity, wheels",
        ),
    ],
)
def test_bad_command_is_rejected_and_leaves_nothing_behind(refusal, arguments, message):
    assert refusal("plan", "export-gazebo", *arguments).startswith(message)
    assert list(Path().iterdir()) == []
