"""The nodes scene and teleop, and recordings, in ROS 2."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import re
import subprocess
import sys

import pytest
from peer import ALL_LATCHED, MISSION
from rosbags.highlevel import AnyReader
from running import environment, running

from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

SCENE = (sys.executable, "-m", "robotteamsim.ros2.scene")
MANAGER = (sys.executable, "-m", "robotteamsim.ros2.mission_manager", "--ros-args")
TELEOP = (sys.executable, "-m", "robotteamsim.ros2.teleop", "--ros-args", "-r", "__ns:=/robot_0")
ADD, DELETE_ALL = 0, 3


def drawn(messages):
    """Return namespace and id of the markers that a viewer shows after these messages."""
    shown = set()
    for marker in (marker for message in messages for marker in message.markers):
        assert marker.header.frame_id == "map"
        key = marker.ns, marker.id
        shown = {*shown, key} if marker.action == ADD else set() if marker.action == DELETE_ALL else shown - {key}
    return shown


def namespaces(messages):
    return {namespace for namespace, _ in drawn(messages)}


def test_late_viewer_gets_the_whole_scene_of_a_mission(tmp_path, peer):
    mission = (*MISSION, "garage_sar", "--controllers", "inside", "--speed", "2")
    with running(mission, tmp_path) as simulation, running(SCENE, tmp_path) as scene:
        simulation.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        layers = ("building", "doors", "voice", "areas", "victims", "robots", "trails", "links", "headline")
        found = {name: peer.listen(f"/scene/{name}", "visualization_msgs/MarkerArray", ALL_LATCHED) for name in layers}
        frames = peer.listen("/tf_static", "tf2_msgs/TFMessage", ALL_LATCHED)
        wanted = {
            "building": {"floor", "walls"},
            "doors": {"doors"},
            "voice": {"voice"},
            "areas": {"areas", "area_numbers"},
            "victims": {"victims", "victim_rings", "victim_names"},
            "trails": {"trails"},
            "links": {"links"},
            "headline": {"headline", "legend", "legend_words"},
        }
        for name, drawings in wanted.items():
            peer.wait_until(lambda name=name, drawings=drawings: namespaces(found[name]) == drawings, name)
        bodies = {("bodies", 0), ("bodies", 1), ("bodies", 2)}
        peer.wait_until(lambda: bodies <= drawn(found["robots"]), "three robots")
        assert [(link.header.frame_id, link.child_frame_id) for link in frames[-1].transforms] == [("map", "building")]
    for program in (simulation, scene):
        assert "Traceback" not in program.output
        assert "cannot be drawn" not in program.output


def test_answer_that_is_lost_is_asked_for_again(tmp_path, peer, lose_first_answer):
    mission = (*MISSION, "garage_sar", "--controllers", "inside", "--speed", "2")
    with running(mission, tmp_path) as simulation, running(SCENE, tmp_path):
        found = peer.listen("/scene/building", "visualization_msgs/MarkerArray", ALL_LATCHED)
        peer.wait_until(lambda: namespaces(found) == {"floor", "walls"}, "the building")
    times_s = [float(one) for one in re.findall(r"answer \d+ after ([0-9.]+) s", simulation.output)]
    assert times_s[1] - times_s[0] < 9.0
    assert "failed to send response (timeout)\n" in simulation.output
    assert "RuntimeWarning" not in simulation.output


def test_scene_with_a_scenario_of_its_own_needs_no_simulation(tmp_path, peer):
    with running((*SCENE, "--ros-args", "-p", "scenario:=tutorial_arena"), tmp_path):
        found = peer.listen("/scene/building", "visualization_msgs/MarkerArray", ALL_LATCHED)
        peer.wait_until(lambda: namespaces(found) == {"floor", "walls"}, "the building")


@contextlib.contextmanager
def typing(keys: bytes, *arguments: str, folder):
    """Run teleop in a terminal in which keys are pressed."""
    keyboard, terminal = pty.openpty()
    command = (*TELEOP, *arguments)
    program = subprocess.Popen(command, stdin=terminal, stdout=subprocess.PIPE, cwd=folder, env=environment(folder))
    try:
        assert b"Hold a key to drive" in program.stdout.readline()
        yield lambda: os.write(keyboard, keys)
    finally:
        program.terminate()
        program.wait()
        program.stdout.close()
        os.close(keyboard)
        os.close(terminal)


@pytest.mark.parametrize("arguments", [(), ("-p", "stamped_cmd_vel:=true")], ids=["twist", "stamped"])
def test_keyboard_drives_a_robot(tmp_path, peer, arguments):
    arena = (*MISSION, "tutorial_arena", "--controllers", "none", "--speed", "1", "--ros-args", *arguments)
    with running(arena, tmp_path), typing(b"i", *arguments, "-p", "speed_mps:=0.25", folder=tmp_path) as press:
        truth = peer.listen("/robot_0/base_pose_ground_truth", "nav_msgs/Odometry")
        moves = lambda: press() and truth and abs(truth[-1].twist.twist.linear.x - 0.25) < 0.01  # noqa: E731
        peer.wait_until(moves, "the motion")
        peer.wait_until(lambda: abs(truth[-1].twist.twist.linear.x) < 1e-6, "the stop")


def test_keyboard_needs_a_terminal(tmp_path, peer):
    with running(TELEOP, tmp_path) as teleop:
        assert teleop.wait() == 2
    assert "there is no terminal to read keys from" in teleop.output
    assert "Traceback" not in teleop.output


def messages(path):
    with AnyReader([path]) as reader:
        return [(connection.topic, time_ns, bytes(data)) for connection, time_ns, data in reader.messages()]


@pytest.mark.parametrize(("name", "writer"), [("there.mcap", McapWriter), ("there.bag", BagWriter)])
def test_recording_is_that_of_a_run_without_ros_to_the_byte(tmp_path, peer, name, writer):
    overrides = ("run.seed=7", "mission.time_limit_s=5")
    command = (*MISSION, "garage_sar", "--seed", "7", "--set", overrides[1], "--lockstep", "--speed", "0")
    with running((*command, "--ros-args", "-p", f"record:={name}"), tmp_path) as mission:
        assert mission.wait() == 0, mission.output
    Simulation(load("garage_sar", overrides)).run([writer(tmp_path / f"headless_{name}", localized=True)])
    recorded = messages(tmp_path / name)
    assert len(recorded) > 1000
    assert recorded == messages(tmp_path / f"headless_{name}")


def test_recording_of_an_unknown_kind_is_refused(tmp_path, peer):
    simulation = (sys.executable, "-m", "robotteamsim.ros2.simulation", "--ros-args", "-p", "scenario:=garage_sar")
    with running((*simulation, "-p", "record:=there.db3"), tmp_path) as node:
        assert node.wait() == 2, node.output
    assert "~record: 'there.db3'; expected a name that ends in .bag or .mcap" in node.output


def test_mission_manager_judges_the_mission_of_the_simulation_step_by_step(tmp_path, peer):
    settings = ("--lockstep", "--seed", "7", "--speed", "0", "--set", "mission.time_limit_s=30", "--paused")
    manager = (*MANAGER, "-p", "out:=judged")
    with running((*MISSION, "garage_sar", *settings, "--out", "own"), tmp_path) as mission:
        statuses = [
            peer.listen(f"{name}/mission/status", "robotteamsim/MissionStatus") for name in ("", "/mission_manager")
        ]
        with running(manager, tmp_path) as judged:
            for name in ("", "/mission_manager"):
                peer.wait_until(lambda name=name: peer.node.count_publishers(f"{name}/mission/status"), name)
            peer.wait_until(
                lambda: peer.node.count_subscribers("/robot_2/controller/status") > 1, "the manager's inputs"
            )
            peer.call("/simulation/resume", "std_srvs/Trigger")
            assert mission.wait() == judged.wait() == 0, judged.output
    own, found = ({m.header.stamp.sec * 10**9 + m.header.stamp.nanosec: m for m in one} for one in statuses)
    assert len(own) > 300
    assert {stamp: own[stamp] for stamp in own if stamp} == {stamp: found[stamp] for stamp in found if stamp}
    results = [json.loads((tmp_path / name / "mission.json").read_text())["result"] for name in ("own", "judged")]
    assert [result.pop("wall_s") > 0.0 for result in results] == [True, True]
    assert results[0] == results[1]
