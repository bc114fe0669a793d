"""Robots that map a building that nobody knows: the same mission in ROS as without it."""

from __future__ import annotations

import json

import numpy as np
import pytest
from rosbags.rosbag1 import Reader
from running import ROSLAUNCH, running

from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation


@pytest.mark.parametrize(("name", "hosted"), [("garage_unknown", "nodes"), ("office_unknown", "inside")])
def test_unknown_building_in_lockstep_has_the_bits_and_beliefs_of_the_headless_mission(name, hosted, tmp_path):
    settings = ("mission.time_limit_s=30", "network.publish_matrices=false")
    command = (*ROSLAUNCH, "robotteamsim", "mission.launch", f"scenario:={name}", "rviz:=false", "lockstep:=true")
    options = ("speed:=0", f"controllers:={hosted}", "out:=results", "record:=true", "bag:=run.bag")
    with running((*command, f"set:={' '.join(settings)}", *options), tmp_path) as program:
        assert program.wait() == 0, program.output
    found = json.loads((tmp_path / "results" / "mission.json").read_text())
    headless = Simulation(load(name, list(settings))).run([BagWriter(tmp_path / "headless.bag")])
    assert found["result"]["trajectory_hash"] == headless.trajectory_hash
    with Reader(tmp_path / "run.bag") as recorded, Reader(tmp_path / "headless.bag") as written:
        counts = [{c.topic: c.msgcount for c in bag.connections} for bag in (recorded, written)]
    # No step waits for a map, so the last one may come too late.
    maps = [[of_bag.pop(f"/robot_{i}/map") for i in range(3)] for of_bag in counts]
    assert counts[0] == counts[1]
    assert counts[0]["/robot_2/amcl_pose"] == counts[0]["/robot_2/localisation"] == headless.steps
    assert all(ours >= theirs - 1 > 3 for ours, theirs in zip(*maps, strict=True))
    assert beliefs(tmp_path / "run.bag") == beliefs(tmp_path / "headless.bag")


def test_particles_in_lockstep_are_those_of_the_headless_mission(tmp_path):
    settings = ("control.localisation=laser", "robots.count=2", "mission.time_limit_s=10")
    command = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", "rviz:=false", "lockstep:=true", "speed:=0")
    options = ("out:=results", "record:=true", "bag:=run.bag")
    with running((*command, f"set:={' '.join(settings)}", *options), tmp_path) as program:
        assert program.wait() == 0, program.output
    found = json.loads((tmp_path / "results" / "mission.json").read_text())
    headless = Simulation(load("garage_sar", list(settings))).run([BagWriter(tmp_path / "headless.bag")])
    assert found["result"]["trajectory_hash"] == headless.trajectory_hash
    shown, expected = (clouds(tmp_path / name) for name in ("run.bag", "headless.bag"))
    # No step waits for a cloud, so the last one may come too late.
    assert shown == expected[: len(shown)]
    assert len(shown) >= len(expected) - 1 > 6


def clouds(path):
    """Return the particles of a robot in each message, as x, y [m]; a yaw that was sent twice is rounded twice."""
    with BagReader([path]) as bag:
        messages = [message for _, _, message in bag.messages(["/robot_1/particlecloud"])]
    return [[(one.position.x, one.position.y) for one in message.poses] for message in messages]


def beliefs(path):
    """Return the first maps of a robot, and where it believed to be by stamp."""
    maps, places = [], {}
    with BagReader([path]) as bag:
        for topic, stamp_ns, message in bag.messages(["/robot_1/map", "/robot_1/amcl_pose"]):
            if topic.endswith("map"):
                maps.append((message.info.width, message.info.height, np.asarray(message.data).tobytes()))
            else:
                places[stamp_ns] = message.pose.pose.position.x, message.pose.pose.position.y
    return maps[:4], places
