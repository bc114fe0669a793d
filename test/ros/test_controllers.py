"""Controllers of others, faulty ones, and one process for the whole team, started as a user does."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path

import pytest
from running import ROSLAUNCH, running

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial_controller.md"
PRINTED = re.findall(r"```python\n(.*?)```", TUTORIAL.read_text(), re.DOTALL)
FAULTY = """
from my_controller import MyController
from robotteamsim.interface import Decision
from robotteamsim.geometry import Twist


class Faulty(MyController):
    def step(self, observation, inbox, task):
        if self.robot_id == 1 and observation.sim_time_ns == 2_000_000_000:
            return Decision(Twist(float("nan")))
        return super().step(observation, inbox, task)
"""
MINE = "control.algorithm=my_controller:MyController"
LOCKSTEP = ("lockstep:=true", "speed:=0", "rviz:=false")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the tutorial's files as printed, where Python finds them."""
    for name, text in zip(("my_controller.py", "my_node.py"), PRINTED, strict=True):
        (tmp_path / name).write_text(text)
    (tmp_path / "faulty_of_test.py").write_text(FAULTY)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{os.environ['PYTHONPATH']}")
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def result_of(folder: Path) -> dict:
    return json.loads((folder / "out" / "mission.json").read_text())["result"]


@pytest.mark.parametrize(
    ("hosted", "overrides"),
    [
        ("nodes", (MINE, "mission.time_limit_s=10")),
        ("inside", (MINE, "mission.time_limit_s=10")),
        ("team", ("control.algorithm=search", "voice.noise_db=30", "mission.time_limit_s=40")),
    ],
)
def test_controllers_drive_by_the_same_bits_as_headless(hosted, overrides, folder):
    command = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", f"controllers:={hosted}", *LOCKSTEP, "out:=out")
    with running((*command, "robots:=4", "seed:=7", f"set:={' '.join(overrides)}"), folder) as program:
        assert program.wait() == 0, program.output
        assert ("process[controllers-" in program.output) == (hosted != "inside")
    headless = Simulation(load("garage_sar", [*overrides, "run.seed=7", "robots.count=4"])).run()
    assert result_of(folder)["trajectory_hash"] == headless.trajectory_hash


@pytest.mark.parametrize("hosted", ["nodes", "team", "inside"])
def test_faulty_controller_stops_its_robot_and_the_mission_reports_why(hosted, folder):
    command = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", f"controllers:={hosted}", *LOCKSTEP, "out:=out")
    overrides = "control.algorithm=faulty_of_test:Faulty mission.time_limit_s=8"
    with running((*command, f"set:={overrides}"), folder) as program:
        assert program.wait() == 0, program.output
    told = "robot 1 is stopped: step returned Twist(linear_x_mps=nan"
    assert len([line for line in program.lines if told in line and "INFO" in line]) == 1, program.output
    assert "time limit reached" in program.output
    assert "Traceback" not in program.output
    driven_m = [robot["distance_m"] for robot in result_of(folder)["robots"]]
    assert driven_m[1] < 1.0 < min(driven_m[0], driven_m[2])


def test_node_of_the_tutorial_drives_the_robot(folder):
    command = (
        *ROSLAUNCH,
        "robotteamsim",
        "mission.launch",
        "scenario:=tutorial_arena",
        "controllers:=none",
        "rviz:=false",
        "out:=out",
    )
    with running((*command, "set:=mission.time_limit_s=10", "speed:=2"), folder) as program:
        program.wait_for(lambda line: "process[simulation" in line, "the mission's start")
        port = program.port
        with with_master(port, folder, "my_node.py") as node:
            assert program.wait() == 0, program.output
            assert "Traceback" not in node.output
    assert result_of(folder)["robots"][0]["distance_m"] > 1.0


def test_garbage_on_topics_neither_ends_nor_hangs_a_node(folder):
    command = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", "controllers:=team", "rviz:=false", "out:=out")
    (folder / "garbage.py").write_text((Path(__file__).parent / "publish_garbage.py").read_text())
    with running((*command, "set:=mission.time_limit_s=30", "speed:=3"), folder) as program:
        program.wait_for(lambda line: "process[simulation" in line, "the mission's start")
        with with_master(program.port, folder, "garbage.py"):
            assert program.wait() == 0, program.output
    assert "time limit reached" in program.output
    assert "Traceback" not in program.output
    assert "ignoring messages that cannot be read" in program.output
    result = result_of(folder)
    assert result["time_s"] == pytest.approx(30.0, abs=0.2)
    assert min(robot["distance_m"] for robot in result["robots"]) > 1.0


def test_invalid_place_for_controllers_ends_the_launch_with_one_line(folder):
    command = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", "controllers:=tema", "rviz:=false")
    with running(command, folder) as program:
        program.wait()
    assert program.output.count("/robotteamsim/controllers: tema; expected nodes, team, inside, none") == 1
    assert "Traceback" not in program.output


def with_master(port: int, folder: Path, script: str):
    """Run a script of the folder as a node of robot 0 at another program's master."""
    command = ("env", f"ROS_MASTER_URI=http://localhost:{port}", "ROS_NAMESPACE=robot_0", sys.executable)
    return running((*command, str(folder / script)), folder)
