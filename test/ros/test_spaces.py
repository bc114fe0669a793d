"""Starts the package by rosrun and roslaunch where only one setup.bash was sourced: of the build or an installation."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from running import running

BUILD = Path(__file__).parents[2] / "build"
SET_BY_ANOTHER_SETUP = ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH", "ROS_PACKAGE_PATH")


@pytest.fixture(scope="module", params=["devel", "install"])
def setup_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    if request.param == "devel":
        return BUILD / "devel" / "setup.bash"
    folder = tmp_path_factory.mktemp("install")
    env = os.environ | {"DESTDIR": str(folder)}
    done = subprocess.run(("cmake", "--install", str(BUILD)), env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return next(folder.rglob("setup.bash"))


def in_terminal(setup_file: Path, command: str) -> tuple[str, ...]:
    unset = [word for name in SET_BY_ANOTHER_SETUP for word in ("-u", name)]
    return ("env", *unset, "PATH=/usr/bin:/bin", "bash", "-c", f"source {setup_file} && exec {command}")


@pytest.mark.parametrize(
    ("node", "line"),
    [
        *((node, "waiting for the ROS master at") for node in ("simulation", "controllers", "scene")),
        ("rviz_view", "rviz_view: rviz starts"),
    ],
)
def test_rosrun_starts_a_node(setup_file: Path, node: str, line: str, tmp_path: Path) -> None:
    # rviz_view does not start rviz without a display; whether it is there is rviz's affair.
    with running(in_terminal(setup_file, f"env DISPLAY=:99 rosrun robotteamsim {node}"), tmp_path) as program:
        program.wait_for(lambda written: line in written, line)


def test_roslaunch_runs_a_mission(setup_file: Path, tmp_path: Path) -> None:
    arguments = "rviz:=false lockstep:=true speed:=0 set:=mission.time_limit_s=2"
    launch = in_terminal(setup_file, f"roslaunch robotteamsim garage_sar.launch {arguments}")
    with running(launch, tmp_path) as program:
        assert program.wait() == 0, program.output
    assert "time limit reached" in program.output
    assert "/controller has ended" not in program.output


def test_command_line_is_on_the_path(setup_file: Path, tmp_path: Path) -> None:
    with running(in_terminal(setup_file, "robotteamsim scenario show garage_sar"), tmp_path) as program:
        assert program.wait() == 0, program.output
    assert "name: garage_sar" in program.output
