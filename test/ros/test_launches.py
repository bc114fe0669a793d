"""Starts the launch files as a user does, and looks at what they print and leave behind."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import xmlrpc.client
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
import roslaunch.rlutil
from msgspec.structs import astuple
from rosbags.rosbag1 import Reader
from running import ROSCORE, ROSLAUNCH, TIMEOUT_S, Program, descendants, running, wait_for_port

from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.errors import RecordingError
from robotteamsim.message_parts import robot_name
from robotteamsim.recording import BagWriter, TrajectoryHash
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.topics import ROBOT_TOPICS, TEAM_TOPICS, Topic
from robotteamsim.recording.topics.robots import read_odometry
from robotteamsim.ros.programs import installed
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

LAUNCH_FILES = sorted((Path(__file__).parents[2] / "launch").glob("*.launch"))
OPTIONAL = {"mapping": "gmapping", "amcl": "amcl", "amcl_robot": "amcl"}
"""The package that a launch file needs, and nothing else does."""
GARAGE = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", "rviz:=false", "seed:=7")
STEP_NS = 100_000_000


class Run:
    """What a launch has left behind."""

    def __init__(self, folder: Path) -> None:
        command = (*GARAGE, "lockstep:=true", "speed:=0", "set:=mission.time_limit_s=20 voice.noise_db=12")
        with running((*command, "record:=true", "bag:=run.bag", "out:=results"), folder) as program:
            self.status = program.wait()
            self.output = program.output
        self.bag = folder / "run.bag"
        self.result = json.loads((folder / "results" / "mission.json").read_text())["result"]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return Run(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def headless_hash() -> str:
    overrides = ["mission.time_limit_s=20", "voice.noise_db=12", "run.seed=7"]
    return Simulation(load("garage_sar", overrides)).run().trajectory_hash


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.stem)
def test_launch_file_passes_roslaunch_check(path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    stand_in(tmp_path, "gmapping", "slam_gmapping")
    stand_in(tmp_path, "amcl", "amcl")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{os.environ['ROS_PACKAGE_PATH']}:{tmp_path}")
    lacks = f"Missing package dependencies: robotteamsim/package.xml: {OPTIONAL.get(path.stem)}"
    assert (roslaunch.rlutil.check_roslaunch(str(path)) or "") == (lacks if path.stem in OPTIONAL else "")


def stand_in(folder: Path, name: str, program: str) -> None:
    """Make a package with a program, for where there is no other."""
    package = folder / name
    package.mkdir()
    (package / "package.xml").write_text(f"<package><name>{name}</name><version>0.0.0</version></package>")
    (package / program).write_text("#!/bin/sh\n")
    (package / program).chmod(0o755)


@pytest.mark.skipif(installed("gmapping", "slam_gmapping") is not None, reason="gmapping is installed")
def test_mapping_without_gmapping_ends_before_it_starts_with_one_line_that_says_so(tmp_path: Path) -> None:
    with running((*ROSLAUNCH, "robotteamsim", "mapping.launch"), tmp_path) as program:
        assert program.wait() != 0
    assert program.output.count("slam_gmapping (ROS package gmapping) is not installed") == 1
    assert "process[" not in program.output
    assert "Traceback" not in program.output


@pytest.mark.skipif(installed("gmapping", "slam_gmapping") is not None, reason="gmapping is installed")
def test_mapping_starts_gmapping_in_the_namespace_of_its_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in(tmp_path, "gmapping", "slam_gmapping")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{os.environ['ROS_PACKAGE_PATH']}:{tmp_path}")
    command = (
        *ROSLAUNCH,
        "--args",
        "/robot_1/slam_gmapping",
        "robotteamsim",
        "mapping.launch",
        "robots:=2",
        "robot:=1",
    )
    with running(command, tmp_path) as program:
        assert program.wait() == 0
    path = tmp_path / "gmapping" / "slam_gmapping"
    assert f'ROS_NAMESPACE="/robot_1" {path} scan:=base_scan __name:=slam_gmapping' in program.output


SILENT = {"/world/people", "controller/belief"}
"""Topics without a message in this mission: nobody flees, and no robot has a belief."""


def test_launch_ends_with_the_mission_and_its_totals(run: Run, headless_hash: str) -> None:
    assert run.status == 0
    assert "simulation-2] has died!\nprocess has finished cleanly" in run.output
    assert "time limit reached" in run.output
    explained, died = (run.output.index(text) for text in ("this is the normal end", "has died!"))
    assert explained < died
    assert run.output.count("mission starts: 5 areas") == 1
    assert f"trajectories {headless_hash}" in run.output
    assert (run.result["trajectory_hash"], run.result["noise_db"]) == (headless_hash, 12.0)
    assert "Traceback" not in run.output


def topics_of_robot() -> list[Topic]:
    """Return the topics of each robot of garage_sar that have messages in a bag."""
    scenario = load("garage_sar")
    return [one for one in ROBOT_TOPICS if one.in_bags and one.is_in(scenario) and one.name not in SILENT]


def test_recorded_bag_has_the_topics_and_types_of_a_headless_bag(run: Run) -> None:
    scenario = load("garage_sar")
    wanted = [topic for topic in TEAM_TOPICS if topic.is_in(scenario) and topic.name not in SILENT]
    expected = {topic.name: topic.type_name for topic in wanted}
    for robot_id in range(3):
        name = robot_name(robot_id)
        expected |= {f"/{name}/{topic.name}": topic.type_name for topic in topics_of_robot()}
    with Reader(run.bag) as bag:
        found = {name: topic.msgtype.replace("/msg/", "/") for name, topic in bag.topics.items() if topic.msgcount}
    assert found == expected


def test_bag_of_a_fast_mission_in_lockstep_lacks_no_message(tmp_path: Path) -> None:
    # 100 s are 1000 steps and the one in which the mission ends; the clock has 5 ticks in each of them. Controllers in
    # the node of the simulation make it fast: `rosbag record`, which drops what waits, had 656 to 896 of the messages.
    settings = ("lockstep:=true", "speed:=0", "controllers:=inside", "set:=mission.time_limit_s=100")
    with running((*GARAGE, *settings, "record:=true", "bag:=run.bag"), tmp_path) as program:
        assert program.wait() == 0, program.output
    assert "/recorder" not in program.output
    each_step = {"/network/links", "/network/state", "/mission/status", "/tf"}
    each_step |= {f"/{robot_name(robot_id)}/{topic.name}" for robot_id in range(3) for topic in topics_of_robot()}
    with Reader(tmp_path / "run.bag") as bag:
        counts = {name: bag.topics[name].msgcount for name in (*each_step, "/clock")}
    assert counts == dict.fromkeys(each_step, 1001) | {"/clock": 5005}
    assert read_run([tmp_path / "run.bag"]).gaps == ()


def test_recording_is_closed_when_the_terminal_is(tmp_path: Path) -> None:
    # roslaunch receives the signals of the terminal, and ends its nodes; a node in a terminal of its own receives both.
    with running((*GARAGE, "speed:=1", "record:=true", "bag:=run.bag"), tmp_path) as program:
        program.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        (node,) = [pid for pid in descendants(program.process.pid) if b"__name:=simulation" in command_line(pid)]
        for pid in (node, node, program.process.pid):
            os.kill(pid, signal.SIGHUP)
        program.wait()
    assert "Traceback" not in program.output
    assert sorted(path.name for path in tmp_path.glob("run.bag*")) == ["run.bag"]
    assert read_run([tmp_path / "run.bag"]).gaps == ()


def command_line(pid: int) -> bytes:
    return Path(f"/proc/{pid}/cmdline").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "recorder"),
    [
        (("scenario.launch",), False),
        (("scenario.launch", "recorder:=rosbag"), True),
        (("scenario.launch", "elsewhere:=1"), True),
        (("scenario.launch", "world:=false"), True),
        (("scenario.launch", "record:=false", "recorder:=rosbag"), False),
        (("scenario.launch", "controllers:=none"), True),  # commands of others are not in the steps of the simulation
        (("teleop.launch",), True),
    ],
)
def test_rosbag_records_only_where_other_nodes_publish_or_the_user_wants_it(
    arguments: tuple[str, ...], recorder: bool, tmp_path: Path
) -> None:
    launch, *others = arguments
    with running((*ROSLAUNCH, "--nodes", "robotteamsim", launch, "record:=true", *others), tmp_path) as program:
        assert program.wait() == 0, program.output
    assert ("/recorder" in program.output.split()) == recorder


def test_unknown_recorder_is_rejected(tmp_path: Path) -> None:
    with running((*ROSLAUNCH, "robotteamsim", "scenario.launch", "recorder:=tape"), tmp_path) as program:
        assert program.wait() != 0
    assert program.output.count("recorder:=tape; expected simulation or rosbag") == 1
    assert "Traceback" not in program.output


def test_recorded_bag_holds_the_trajectories_of_the_hash(run: Run, headless_hash: str) -> None:
    assert trajectory_hash(run.bag, run.result["steps"]) == headless_hash


def test_recorded_bag_is_one_that_rosbag_info_can_read(run: Run) -> None:
    assert re.search(r"/mission/events +\d+ msgs +: robotteamsim/MissionEvent", rosbag("info", str(run.bag)))


def test_recorded_bag_is_analysed_to_the_totals_of_the_run(run: Run) -> None:
    analysed, result = run_totals(read_run([run.bag])), run.result
    assert analysed.mission is not None
    mission = dataclasses.asdict(analysed.mission)
    assert mission == {name: result[name] for name in mission}
    assert [robot.distance_m for robot in analysed.robots] == [robot["distance_m"] for robot in result["robots"]]
    assert [robot.contact_s for robot in analysed.robots] == [robot["contact_s"] for robot in result["robots"]]
    assert (analysed.trajectory_hash, analysed.omitted) == (result["trajectory_hash"], ())


def test_recorded_bag_is_analysed_as_the_headless_bag_of_the_same_seed(run: Run, tmp_path: Path) -> None:
    overrides = ["mission.time_limit_s=20", "voice.noise_db=12", "run.seed=7"]
    Simulation(load("garage_sar", overrides)).run([BagWriter(tmp_path / "run.bag")])
    in_ros, headless = read_run([run.bag]), read_run([tmp_path / "run.bag"])
    assert run_totals(in_ros) == run_totals(headless)
    assert [event for _, event in in_ros.events] == [event for _, event in headless.events]
    # In ROS the mission tells that it waits, before the first step comes.
    assert [one for one in in_ros.statuses if one[1].state != "waiting"] == list(headless.statuses)
    assert in_ros.network is not None
    assert headless.network is not None
    np.testing.assert_array_equal(in_ros.network.hop_count, headless.network.hop_count)
    for ours, theirs in zip(in_ros.robots, headless.robots, strict=True):
        np.testing.assert_array_equal(ours.track.poses, theirs.track.poses)


@pytest.mark.parametrize("compression", ["--bz2", "--lz4"])
def test_bag_that_rosbag_compresses_gives_the_same_analysis(run: Run, tmp_path: Path, compression: str) -> None:
    packed = shutil.copy(run.bag, tmp_path / "run.bag")
    rosbag("compress", "--quiet", compression, str(packed))
    assert packed.stat().st_size < 0.7 * run.bag.stat().st_size
    assert run_totals(read_run([packed])) == run_totals(read_run([run.bag]))


def test_parts_that_rosbag_makes_are_analysed_as_one(run: Run, tmp_path: Path) -> None:
    parts = tmp_path / "run.bag", tmp_path / "later.bag"
    rosbag("filter", str(run.bag), str(parts[0]), "t.to_sec() < 8")
    rosbag("filter", str(run.bag), str(parts[1]), "t.to_sec() >= 8")
    assert run_totals(read_run(parts)) == run_totals(read_run([run.bag]))


def test_truncated_bag_is_rejected_and_analysed_after_rosbag_reindex(run: Run, tmp_path: Path) -> None:
    part = tmp_path / "run.bag"
    part.write_bytes(run.bag.read_bytes()[: run.bag.stat().st_size * 3 // 4])
    with pytest.raises(RecordingError, match="`rosbag reindex "):
        read_run([part])
    rosbag("reindex", "--quiet", "--force", str(part))
    saved = run_totals(read_run([part]))
    assert saved.mission is not None
    assert (saved.mission.end, saved.mission.scenario) == ("", "garage_sar")
    assert 5.0 < saved.mission.time_s < 20.0


def test_replay_plays_the_bag_and_ends(run: Run, tmp_path: Path) -> None:
    command = (*ROSLAUNCH, "robotteamsim", "replay.launch", f"bag:={run.bag}", "rviz:=false", "rate:=20")
    with running(command, tmp_path) as program:
        assert program.wait() == 0
    assert "player-2] has died!\nprocess has finished cleanly" in program.output


def test_launch_ends_and_names_the_node_that_died(tmp_path: Path) -> None:
    with running(GARAGE, tmp_path) as program:
        program.wait_for(lambda line: "mission starts" in line, "the mission's start")
        os.kill(process_of(program.port, "/robot_1/controller"), signal.SIGKILL)
        program.wait()
    assert "/robot_1/controller has ended" in program.output
    assert re.search(r"REQUIRED process \[controllers-\d+\] has died!", program.output)


def test_mission_of_three_robots_has_six_processes(tmp_path: Path) -> None:
    with running(GARAGE, tmp_path) as program:
        program.wait_for(lambda line: "mission starts" in line, "the mission's start")
        assert len(descendants(program.process.pid)) == 6


def process_of(port: int, node: str) -> int:
    """Return the id of a node's process."""
    with xmlrpc.client.ServerProxy(f"http://localhost:{port}") as master:
        uri = master.lookupNode("/test", node)[2]
    with xmlrpc.client.ServerProxy(uri) as found:
        return found.getPid("/test")[2]


def test_launches_one_after_another_at_one_master_do_not_inherit_parameters(tmp_path: Path) -> None:
    world = (*ROSLAUNCH, "robotteamsim", "world.launch", "scenario:=tutorial_arena", "robots:=1", "prefix:=false")
    mission = (*GARAGE, "lockstep:=true", "speed:=0", "set:=mission.time_limit_s=2")
    with running(ROSCORE, tmp_path) as core:
        wait_for_port(core.port)
        for command in (world, mission, world):
            with running(command, tmp_path, core.port) as program:
                program.wait_for(lambda line: "process[simulation" in line, "the start of the simulation")
                if command == mission:
                    program.wait()
                    assert "time limit reached" in program.output, program.output
                else:
                    wait_for_topic(core.port, "/odom")
                assert "FATAL" not in program.output, program.output


def test_roswtf_has_no_warning_about_a_world_whose_robots_are_commanded(tmp_path: Path) -> None:
    world = (*ROSLAUNCH, "robotteamsim", "world.launch", "scenario:=tutorial_arena", "robots:=2")
    still = ("geometry_msgs/Twist", "{}", "-r", "5")
    with ExitStack() as stack:
        core = stack.enter_context(running(ROSCORE, tmp_path))
        wait_for_port(core.port)
        launched = stack.enter_context(running(world, tmp_path, core.port))
        for index in range(2):
            stack.enter_context(running(("rostopic", "pub", f"/robot_{index}/cmd_vel", *still), tmp_path, core.port))
        for topic in ("/robot_0/cmd_vel", "/robot_1/cmd_vel", "/robot_1/odom"):
            wait_for_topic(core.port, topic, launched)
        online, end_s = "", time.monotonic() + TIMEOUT_S
        while online != "No errors or warnings" and time.monotonic() < end_s:  # topics are there before connections
            with running(("roswtf",), tmp_path, core.port) as program:
                program.wait()
            online = program.output.partition("Online checks summary:")[2].strip()
    assert online == "No errors or warnings", f"{program.output}\n{launched.output}"


def wait_for_topic(port: int, name: str, program: Program | None = None) -> None:
    """Wait until somebody publishes a topic, such as a program, whose output a failure shows."""
    deadline_s = time.monotonic() + TIMEOUT_S
    with xmlrpc.client.ServerProxy(f"http://localhost:{port}") as master:
        while not any(topic == name for topic, _ in master.getPublishedTopics("/test", "")[2]):
            assert time.monotonic() < deadline_s, f"nobody publishes {name}\n{program.output if program else ''}"
            time.sleep(0.1)


@pytest.mark.parametrize(
    ("argument", "line"),
    [
        ("set:=voice.noise_db=99", "--set: voice.noise_db: 99 is above 80"),
        ("scenario:=garage_sra", "garage_sra: no shipped scenario of this name; did you mean 'garage_sar'?"),
    ],
)
def test_wrong_argument_ends_the_launch_with_one_line_and_status_2(argument: str, line: str, tmp_path: Path) -> None:
    with running((*GARAGE, argument), tmp_path) as program:
        program.wait()
    assert program.output.count(line) == 1
    assert "REQUIRED process [simulation-2] has died!" in program.output
    assert "exit code 2" in program.output
    assert "Traceback" not in program.output


@pytest.mark.parametrize(
    ("arguments", "line", "node"),
    [
        (
            ("gzserver:=no_gazebo",),
            "~gzserver: 'no_gazebo' is not installed; install Gazebo 11 (Debian 11: gazebo,",
            "gazebo-3",
        ),
        (("scenario:=garage_fire",), "garage_fire: Gazebo's world has no fire; expected world:=true", "gazebo-3"),
        (("lockstep:=true",), "/robotteamsim/lockstep: true; expected false with robots in another", "simulation-2"),
    ],
    ids=["not installed", "fire", "lockstep"],
)
def test_launch_that_gazebo_cannot_run_ends_with_one_line(
    arguments: tuple[str, ...], line: str, node: str, tmp_path: Path
) -> None:
    launch = (*ROSLAUNCH, "robotteamsim", "scenario.launch", "world:=gazebo", "controllers:=team", "rviz:=false")
    with running((*launch, *arguments), tmp_path) as program:
        program.wait()
    assert program.output.count(line) == 1
    assert f"REQUIRED process [{node}] has died!" in program.output
    assert "Traceback" not in program.output


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("world:=gazbo",), "world:=gazbo; expected true, gazebo or false"),
        (("in_gazebo:=1",), "in_gazebo:=1; expected world:=gazebo"),
        (("world:=gazebo", "elsewhere:=2"), "elsewhere:=2; expected world:=true"),
    ],
)
def test_worlds_that_do_not_fit_are_rejected(arguments: tuple[str, ...], line: str, tmp_path: Path) -> None:
    with running((*ROSLAUNCH, "robotteamsim", "scenario.launch", *arguments), tmp_path) as program:
        program.wait()
    assert program.output.count(line) == 1


def test_launch_file_with_no_robot_in_gazebo_is_rejected(tmp_path: Path) -> None:
    arguments = '<arg name="world" value="gazebo"/><arg name="in_gazebo" value=""/>'
    scenario = '<include file="$(find robotteamsim)/launch/scenario.launch">'
    (tmp_path / "none.launch").write_text(f"<launch>{scenario}{arguments}</include></launch>")
    with running((*ROSLAUNCH, "none.launch"), tmp_path) as program:
        program.wait()
    assert program.output.count("in_gazebo:=; expected all, or ids of robots") == 1


def rosbag(*arguments: str) -> str:
    """Call ROS's own tool and return what it prints."""
    command = (sys.executable, "-c", "import rosbag; rosbag.rosbagmain()", *arguments)
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def trajectory_hash(path: Path, steps: int) -> str:
    """Return the hash of the true poses in a bag."""
    typestore, computed = bag_typestore(), TrajectoryHash()
    with Reader(path) as bag:
        robots = zip(*(truths(bag, typestore, robot_id) for robot_id in range(3)), strict=True)
        for step, messages in enumerate(robots, 1):
            if step <= steps:
                poses = [astuple(read_odometry(message).pose) for message in messages]
                computed.update(step * STEP_NS, np.array(poses))
    return computed.hexdigest()


def truths(bag: Reader, typestore: object, robot_id: int) -> Iterator[object]:
    topic = f"/{robot_name(robot_id)}/base_pose_ground_truth"
    connections = [connection for connection in bag.connections if connection.topic == topic]
    for connection, _, data in bag.messages(connections):
        yield typestore.deserialize_ros1(data, connection.msgtype)
