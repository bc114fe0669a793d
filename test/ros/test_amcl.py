"""`amcl.launch`: missions whose robots are located by amcl, or where it is not installed by a simpler localiser."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from running import ROSLAUNCH, running

from robotteamsim.ros.programs import installed

AMCL = (*ROSLAUNCH, "robotteamsim", "amcl.launch", "rviz:=false", "speed:=2")
NO_DRIFT = " ".join(f"robots.odometry.alpha{i}=0" for i in range(1, 5))


@pytest.fixture
def amcl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """amcl, or where it is not installed a package of its name with a simpler localiser."""
    if installed("amcl", "amcl") is not None:
        return
    package = tmp_path / "amcl"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>amcl</name><version>0.0.0</version></package>")
    source = (Path(__file__).parent / "simple_localiser.py").read_text()
    (package / "amcl").write_text(f"#!{sys.executable}\n{source}")
    (package / "amcl").chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{os.environ['ROS_PACKAGE_PATH']}:{tmp_path}")


@pytest.mark.usefixtures("amcl")
def test_located_team_explores_its_area_without_a_warning(tmp_path: Path) -> None:
    area = 'mission.areas=[{"name":"area_1","center":[18,7]}]'
    with running((*AMCL, "robots:=2", "seed:=7", f"set:={NO_DRIFT} {area}"), tmp_path) as program:
        program.wait_for(lambda line: "all areas are explored" in line, "the end of the mission")
        program.wait()
    for unwanted in ("is stopped", "Traceback"):
        assert unwanted not in program.output
    # rospy also warns of clients that have gone before it answers them.
    warnings = [line for line in program.output.splitlines() if "WARN" in line and "Inbound TCP/IP" not in line]
    assert warnings == []


@pytest.mark.usefixtures("amcl")
@pytest.mark.skipif(installed("amcl", "amcl") is not None, reason="amcl corrects a wrong start")
def test_robot_that_is_located_elsewhere_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WRONG_START", "20 0 0")
    command = (*AMCL, "scenario:=tutorial_arena", "robots:=1", f"set:={NO_DRIFT}")
    with running(command, tmp_path) as program:
        program.wait_for(
            lambda line: "beams go through walls of the floor plan at its pose from tf" in line, "a warning"
        )


@pytest.mark.skipif(installed("amcl", "amcl") is not None, reason="amcl is installed")
def test_launch_without_amcl_ends_before_it_starts_with_one_line_that_says_so(tmp_path: Path) -> None:
    with running(AMCL, tmp_path) as program:
        assert program.wait() != 0
    assert program.output.count("amcl (ROS package amcl) is not installed") == 1
    assert "process[" not in program.output
    assert "Traceback" not in program.output
