"""Missions in ROS 2 are those of a run without ROS, to the bit."""

from __future__ import annotations

import json
import os
import re
import signal
from pathlib import Path

import pytest
from peer import MISSION
from rosbags.highlevel import AnyReader
from running import descendants, running

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

SHORT = ("--seed", "7", "--set", "mission.time_limit_s=30", "--speed", "0")


def headless_hash(name: str) -> str:
    return Simulation(load(name, ["run.seed=7", "mission.time_limit_s=30"])).run().trajectory_hash


@pytest.mark.parametrize(
    ("name", "controllers"),
    [
        *(("garage_sar", hosted) for hosted in ("nodes", "team", "inside")),
        *(("garage_unknown", "nodes"), ("office_unknown", "team")),
    ],
)
def test_mission_in_lockstep_has_the_hash_of_a_run_without_ros(tmp_path, name, controllers):
    command = (*MISSION, name, *SHORT, "--lockstep", "--controllers", controllers, "--out", "there")
    with running(command, tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    assert headless_hash(name) in mission.output
    result = json.loads((tmp_path / "there" / "mission.json").read_text())
    assert result["result"]["trajectory_hash"] == headless_hash(name)


def test_fire_with_additional_sensors_has_the_hash_of_a_run_without_ros(tmp_path):
    sensors = "robots.sensors=[{kind: sonar, name: front}, {kind: gps, datum_lat_deg: 40, datum_lon_deg: -8}]"
    command = (*MISSION, "garage_fire", *SHORT, "--set", sensors, "--lockstep")
    with running(command, tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    overrides = ["run.seed=7", "mission.time_limit_s=30", sensors]
    assert Simulation(load("garage_fire", overrides)).run().trajectory_hash in mission.output


def test_robot_that_leaves_and_returns_goes_on_as_without_ros(tmp_path):
    schedule = "schedule=[{at_s: 3, remove: 1}, {at_s: 6, spawn: 1, pose: [20, 5, 0]}]"
    command = (*MISSION, "garage_sar", *SHORT, "--set", schedule, "--lockstep", "--controllers", "team")
    with running(command, tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    overrides = ["run.seed=7", "mission.time_limit_s=30", schedule]
    assert Simulation(load("garage_sar", overrides)).run().trajectory_hash in mission.output


def test_mission_that_cannot_send_all_messages_is_the_same_and_counts_them(tmp_path, break_every_third):
    break_every_third("rclpy.publisher", "Publisher", "publish")
    with running((*MISSION, "garage_sar", *SHORT, "--lockstep", "--controllers", "inside"), tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    assert headless_hash("garage_sar") in mission.output
    failing = re.findall(r"(/\S+): a message could not be sent: Failed to publish: cannot publish data", mission.output)
    assert len(failing) == len(set(failing)) > 1
    assert re.search(r"[1-9]\d+ messages could not be sent, because receivers were too slow", mission.output)
    assert "Traceback" not in mission.output


def test_mission_without_lockstep_ends_well(tmp_path):
    command = (*MISSION, "tutorial_arena", "--seed", "7", "--set", "mission.time_limit_s=20", "--speed", "10")
    with running(command, tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    assert re.search(r"driven\s+[1-9]", mission.output), mission.output


def test_mission_ends_when_a_controller_is_killed(tmp_path):
    with running((*MISSION, "garage_sar", "--speed", "1"), tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        *_, last = descendants(mission.process.pid)
        os.kill(last, signal.SIGKILL)
        assert mission.wait() == 1, mission.output
    assert "a controller has ended, and this ends the mission" in mission.output
    assert "Traceback" not in mission.output


def test_nodes_end_with_their_starter_however_it_ends(tmp_path, peer):
    with running((*MISSION, "garage_sar", "--speed", "1"), tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        nodes = [Path("/proc", str(pid), "cmdline") for pid in descendants(mission.process.pid)]
        assert len(nodes) == 4
        mission.process.kill()
        peer.wait_until(lambda: not any(is_node(node) for node in nodes), "the end of all nodes")
    assert "Traceback" not in mission.output


def is_node(cmdline: Path) -> bool:
    try:
        return b"robotteamsim" in cmdline.read_bytes()
    except OSError:
        return False


def test_wrong_class_of_all_controllers_is_one_line(tmp_path):
    command = (*MISSION, "garage_sar", "--allow-code", "--set", "control.algorithm=json:Nope")
    with running(command, tmp_path) as mission:
        assert mission.wait() == 1, mission.output
    assert mission.output.count("control.algorithm: 'json:Nope'") == 1
    assert mission.output.splitlines()[-1] == "robotteamsim.ros2: a controller has ended, and this ends the mission"


@pytest.mark.parametrize("option", ["--robots", "--teleop"])
def test_number_that_is_negative_is_refused(tmp_path, option):
    with running((*MISSION, "garage_sar", f"{option}=-1"), tmp_path) as mission:
        assert mission.wait() == 2
    assert f"argument {option}: -1; expected a whole number from 0 on" in mission.output


@pytest.mark.parametrize(
    ("parameter", "line"),
    [
        ("simulation:robots:=2", "-p robots; expected the option --robots"),
        ("allow_code:=true", "-p allow_code; expected the option --allow-code"),
        ("seed:=3", "-p seed; expected the option --seed"),
        ("scenario:=office_manet", "-p scenario; expected the first argument"),
    ],
)
def test_parameter_that_has_an_option_is_refused(tmp_path, parameter, line):
    with running((*MISSION, "garage_sar", "--ros-args", "-p", parameter), tmp_path) as mission:
        assert mission.wait() == 2
    assert mission.output == f"robotteamsim.ros2: {line}\n"


@pytest.mark.parametrize("numbers", [(signal.SIGINT,), (signal.SIGHUP, signal.SIGHUP)], ids=["Ctrl-C", "terminal"])
def test_ctrl_c_or_a_closed_terminal_ends_a_mission_and_closes_its_recording(tmp_path, numbers):
    recording = ("--ros-args", "-p", "record:=there.bag")
    with running((*MISSION, "garage_sar", "--speed", "1", *recording), tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        pids = (mission.process.pid, *descendants(mission.process.pid))
        for number in numbers:
            for pid in pids:
                os.kill(pid, number)
        assert mission.wait() == 128 + numbers[0]
    assert mission.output.count("interrupted; /mission/abort ends a mission with its results") == 1
    assert "Traceback" not in mission.output
    assert "a controller has ended" not in mission.output
    assert list(tmp_path.glob("*.bag*")) == [tmp_path / "there.bag"]
    with AnyReader([tmp_path / "there.bag"]) as bag:
        assert bag.message_count > 0


def test_mission_whose_simulation_is_killed_says_so(tmp_path):
    with running((*MISSION, "garage_sar", "--controllers", "inside", "--speed", "1"), tmp_path) as mission:
        mission.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        os.kill(descendants(mission.process.pid)[0], signal.SIGKILL)
        assert mission.wait() == 1, mission.output
    assert "robotteamsim.ros2: the simulation has been killed" in mission.output
