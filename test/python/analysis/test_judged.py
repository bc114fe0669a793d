"""A bag that is judged gives the events, the status of each step and the result of its mission."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import pytest
from rosbags.rosbag1 import Reader, Writer

from robotteamsim.analysis.runs.judged import judge
from robotteamsim.cli import main
from robotteamsim.errors import RecordingError
from robotteamsim.mission.events import Event
from robotteamsim.mission.status import MissionStatus
from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.mcap_writer import McapWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import Scenario, load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
from robotteamsim.view.recorder import FrameRecorder

CASES = {
    "tutorial_arena": [],
    "garage_sar": ["mission.time_limit_s=80"],
    "office_manet": ["mission.time_limit_s=15"],  # a base, relays, exclusion
    "office_fire": ["mission.time_limit_s=25"],  # people who flee, doors, robots that fail
    "garage_rescue": ["mission.time_limit_s=30"],  # firefighters
    "office_egress": ["mission.time_limit_s=20"],  # nobody but people
}


class Steps(Observer):
    """Keeps what the mission says in each step."""

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.statuses: list[MissionStatus] = []

    def step(self, record: StepRecord) -> None:
        self.events += record.events
        self.statuses.append(record.mission)


def recorded(scenario: Scenario, path: Path) -> tuple[Result, Steps]:
    """Run a mission and record it."""
    steps, writer = Steps(), (McapWriter if path.suffix == ".mcap" else BagWriter)(path)
    return Simulation(scenario).run([steps, writer]), steps


def judged(scenario: Scenario, path: Path) -> tuple[Result, Steps]:
    """Judge a recording."""
    steps = Steps()
    return judge(read_run([path]), resolve(scenario), [steps]), steps


def assert_equal(found: tuple[Result, Steps], expected: tuple[Result, Steps]) -> None:
    (result, steps), (expected_result, expected_steps) = found, expected
    assert [(e.time_s, e.detail) for e in steps.events] == [(e.time_s, e.detail) for e in expected_steps.events]
    assert steps.statuses == expected_steps.statuses
    assert msgspec.structs.replace(result, wall_s=0.0) == msgspec.structs.replace(expected_result, wall_s=0.0)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".bag", ".mcap"])
@pytest.mark.parametrize("name", CASES)
def test_recording_of_a_mission_is_judged_as_the_mission(name: str, suffix: str, tmp_path: Path):
    scenario, path = load(name, CASES[name]), tmp_path / f"m{suffix}"
    expected = recorded(scenario, path)
    assert_equal(judged(scenario, path), expected)


def test_robots_that_leave_and_come_are_judged_as_they_were(tmp_path: Path):
    path = tmp_path / "m.bag"
    scenario = load("garage_sar", ["mission.time_limit_s=30", "schedule=[{at_s: 5, remove: 1}, {at_s: 12, spawn: 1}]"])
    expected = recorded(scenario, path)
    assert {event.kind for event in expected[1].events} >= {"robot_removed", "robot_spawned"}
    assert_equal(judged(scenario, path), expected)


def test_true_poses_alone_are_enough(tmp_path: Path):
    scenario, path, poses = load("garage_sar", ["mission.time_limit_s=80"]), tmp_path / "m.bag", tmp_path / "poses.bag"
    expected = recorded(scenario, path)
    assert any(event.kind == "victim_heard" for event in expected[1].events)
    with Reader(path) as reader, Writer(poses) as writer:
        kept = [each for each in reader.connections if each.topic.endswith("base_pose_ground_truth")]
        ids = {each.id: writer.add_connection(each.topic, each.msgtype, typestore=bag_typestore()) for each in kept}
        for connection, time_ns, data in reader.messages(kept):
            writer.write(ids[connection.id], time_ns, data)
    assert_equal(judged(scenario, poses), expected)


def test_what_controllers_say_between_two_steps_counts(tmp_path: Path):
    areas = "[{name: near, center: [6, 4], radius_m: 3}, {name: far, center: [40, 10], radius_m: 1}]"
    settings = ["mission.base=0", "mission.time_limit_s=5", f"mission.areas={areas}"]
    scenario, path, late = load("garage_sar", settings), tmp_path / "m.bag", tmp_path / "late.bag"
    expected = recorded(scenario, path)
    assert any(event.kind == "discovery_delivered" for event in expected[1].events)
    with Reader(path) as reader, Writer(late) as writer:
        types = bag_typestore()
        ids = {one.id: writer.add_connection(one.topic, one.msgtype, typestore=types) for one in reader.connections}
        for connection, time_ns, data in reader.messages():
            changed: bytes | memoryview = data
            if connection.topic.endswith("base_pose_ground_truth"):
                message = types.deserialize_ros1(data, connection.msgtype)
                stamp = message.header.stamp
                stamp.sec, stamp.nanosec = divmod(stamp.sec * 10**9 + stamp.nanosec + 10**6, 10**9)
                changed = types.serialize_ros1(message, connection.msgtype)
            writer.write(ids[connection.id], time_ns, changed)
    _, steps = judged(scenario, late)
    assert [(e.time_s, e.kind) for e in steps.events] == [(e.time_s, e.kind) for e in expected[1].events][:-1]


def test_page_of_a_judged_bag_shows_the_mission(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path, setup = tmp_path / "m.bag", resolve(load("garage_rescue", ["mission.time_limit_s=10"]))
    live, found = FrameRecorder(setup), FrameRecorder(setup)
    Simulation(setup).run([live, BagWriter(path)])
    judge(read_run([path]), setup, [found])
    unknown = {"scans_m": (), "sensors": ()}  # what robots measure is not judged
    expected = [msgspec.structs.replace(frame, **unknown) for frame in live.recording.frames]
    assert found.recording.frames == expected
    assert found.recording.events == live.recording.events
    page, time_limit = tmp_path / "m.html", ["--set", "mission.time_limit_s=10"]
    assert main(["judge", str(path), "--mission", "garage_rescue", *time_limit, "--html", str(page)]) == 0
    assert str(page) in capsys.readouterr().out
    assert page.read_text().startswith("<!doctype html>")
    assert main(["judge", str(path), "--mission", "garage_rescue", "--html", str(path)]) == 2
    assert "a file that this command reads" in capsys.readouterr().err


def test_robot_without_poses_is_absent(tmp_path: Path):
    path = tmp_path / "m.bag"
    scenario = load("garage_sar", ["robots.reserve=1", "mission.time_limit_s=10"])
    expected = recorded(scenario, path)
    assert_equal(judged(scenario, path), expected)


def test_robot_is_absent_before_its_first_pose(tmp_path: Path):
    path, short = tmp_path / "m.bag", "mission.time_limit_s=10"
    recorded(load("garage_sar", [short, "schedule=[{at_s: 0, remove: 1}, {at_s: 5, spawn: 1}]"]), path)
    _, steps = judged(load("garage_sar", [short]), path)
    changes = [(event.kind, event.time_s) for event in steps.events if event.robot_id == 1]
    assert changes[:2] == [("robot_removed", 0.0), ("robot_spawned", 5.0)]


def test_other_rules_give_another_result(tmp_path: Path):
    path = tmp_path / "m.bag"
    recorded(load("garage_sar", ["mission.time_limit_s=40"]), path)
    result, steps = judged(load("garage_sar", ["mission.time_limit_s=20"]), path)
    assert (result.end, result.time_s, len(steps.statuses)) == ("time_limit", 20.0, 201)


def test_recording_may_end_before_the_mission(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "m.bag"
    recorded(load("garage_sar", ["mission.time_limit_s=10"]), path)
    command = ["judge", str(path), "--mission", "garage_sar", "--set", "mission.time_limit_s=600"]
    assert main(command) == 0
    assert capsys.readouterr().out.endswith("  the recording ends before the mission does\n")
    assert main([*command, "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert (shown["end"], shown["time_s"]) == ("", 10.0)
    assert shown["events"][0]["kind"] == "start"


def test_other_teams_are_refused_in_one_line(tmp_path: Path):
    path = tmp_path / "m.bag"
    recorded(load("garage_sar", ["mission.time_limit_s=1"]), path)
    with pytest.raises(RecordingError) as raised:
        judged(load("garage_sar", ["robots.count=2"]), path)
    team = "has the poses of 3 robots (robot_0, robot_1, robot_2)"
    assert str(raised.value) == f"{path}: {team}; expected robot_0 to robot_1 of garage_sar, or as many of other names"
