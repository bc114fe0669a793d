"""Recordings survive packing: what a page decodes is what the simulation had, to the centimetre."""

from __future__ import annotations

import base64
import dataclasses
import itertools
import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from rosbags.rosbag1 import Reader, Writer

from robotteamsim import palette
from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.results import EventList
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Mission
from robotteamsim.simulation import Observer, Simulation
from robotteamsim.view.document import NO_LINK, packed
from robotteamsim.view.frame import FAR_M, finite_ranges
from robotteamsim.view.from_bag import MOST_FRAMES, recording_of
from robotteamsim.view.recorder import FRAME_S, FrameRecorder, Recording


def _unpacked(recording: Recording) -> dict[str, Any]:
    [document] = json.loads(zlib.decompress(base64.b64decode(packed([recording]))))
    found: dict[str, Any] = document
    return found


def test_poses_and_states_are_kept_to_a_hundredth(recording: Recording) -> None:
    known: dict[str, Any] = {}
    for frame, row in zip(recording.frames, _unpacked(recording)["frames"], strict=True):
        known |= row
        assert known["time_s"] == pytest.approx(frame.time_s)
        for pose, kept in zip(frame.poses, known["poses"], strict=True):
            assert kept == pytest.approx(pose, abs=0.00501)
        assert [victim["state"] for victim in known["victims"]] == [victim.state for victim in frame.victims]
        assert known["explored"] == list(frame.explored)


def test_fiedler_values_and_doors_are_kept_to_a_thousandth(recording: Recording) -> None:
    frame = msgspec.structs.replace(recording.frames[0], fiedler_value=0.12345, doors=(0.98765,))
    [kept] = _unpacked(dataclasses.replace(recording, frames=[frame]))["frames"]
    assert (kept["fiedler_value"], kept["doors"]) == (0.123, [0.988])


def test_links_are_kept_exactly(recording: Recording) -> None:
    pairs = [(a, b, np.cumsum(indices), np.cumsum(steps)) for a, b, indices, steps in _unpacked(recording)["links"]]
    for index, frame in enumerate(recording.frames):
        links = []
        for first, second, changed, signals in pairs:
            if changed[0] <= index:
                links.append((first, second, int(signals[np.searchsorted(changed, index, side="right") - 1])))
        assert [link for link in links if link[2] != NO_LINK] == sorted(frame.links)


def test_frames_are_regular_and_end_with_the_mission(recording: Recording) -> None:
    times_s = [frame.time_s for frame in recording.frames]
    gaps_s = [after - before for before, after in itertools.pairwise(times_s)]
    assert gaps_s[:-1] == pytest.approx([FRAME_S] * (len(gaps_s) - 1))
    assert recording.frames[-1].state == "ended"
    assert recording.events[-1].kind == "end"


@pytest.mark.slow
@pytest.mark.parametrize(("name", "writer"), [("mission.bag", BagWriter), ("mission.mcap", McapWriter)])
def test_a_bag_shows_the_same_mission(
    hall_scenario: Callable[..., Scenario], tmp_path: Path, name: str, writer: Callable[[Path], Observer]
) -> None:
    simulation = Simulation(hall_scenario())
    recorder = FrameRecorder(simulation.setup)
    listed = EventList()
    result = simulation.run([recorder, listed, writer(tmp_path / name)])
    assert [event.time_s for event in recorder.recording.events] == [event.time_s for event in listed.events]
    bag = recording_of(read_run([tmp_path / name]), hall_scenario())
    by_time = {round(frame.time_s, 3): frame for frame in recorder.recording.frames}
    compared = 0
    for frame in bag.frames:
        own = by_time.get(round(frame.time_s, 3))
        if own is not None:
            compared += 1
            assert frame.links == own.links
            assert frame.explored == own.explored
            assert frame.victims == own.victims
    assert compared > 100
    assert bag.events == recorder.recording.events
    assert [frame.time_s for frame in (bag.frames[0], bag.frames[-1])] == [0.0, result.time_s]


def test_a_bag_shows_the_lasers_the_doors_and_the_voice_map(
    hall_scenario: Callable[..., Scenario], tmp_path: Path
) -> None:
    door = Door(name="gate", start=(14.0, 4.0), end=(14.0, 5.0), closed=True)
    openings = (ScheduledEvent(at_s=2.0, door="gate", closed=False),)
    scenario = hall_scenario()
    plan = scenario.plan.model_copy(update={"doors": (door,)})
    scenario = hall_scenario(plan=plan, schedule=openings, mission=Mission(time_limit_s=4.0))
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation.setup)
    simulation.run([recorder, BagWriter(tmp_path / "hall.bag")])
    own, bag = recorder.recording, recording_of(read_run([tmp_path / "hall.bag"]), scenario)
    assert {frame.doors for frame in own.frames} == {frame.doors for frame in bag.frames} == {(0.0,), (1.0,)}
    assert [frame.scans_m for frame in bag.frames if frame.scans_m][:4] == [
        frame.scans_m for frame in own.frames if frame.scans_m
    ][:4]
    for robot, other in zip(bag.scene.robots, own.scene.robots, strict=True):
        assert (robot.beams, robot.forward_m, robot.range_max_m) == (other.beams, other.forward_m, other.range_max_m)
        assert robot.angle_min_rad == pytest.approx(other.angle_min_rad, abs=1e-6)  # 32 bits in the message
    assert len(bag.voice) == len(own.voice) == 2
    for layer, other in zip(bag.voice, own.voice, strict=True):
        np.testing.assert_array_equal(layer.values, other.values)
        assert layer.time_s == other.time_s


def test_a_bag_with_impossible_numbers_is_rejected_in_one_line(
    hall_scenario: Callable[..., Scenario], tmp_path: Path
) -> None:
    path, types = tmp_path / "odd.bag", bag_typestore()
    Simulation(hall_scenario(mission=Mission(time_limit_s=1.0))).run([BagWriter(tmp_path / "good.bag")])
    with Reader(tmp_path / "good.bag") as good, Writer(path) as odd:
        connections = {}
        for known, time_ns, data in good.messages():
            if known.topic not in connections:
                connections[known.topic] = odd.add_connection(known.topic, known.msgtype, typestore=types)
            if known.topic == "/voice_map/values":
                message = types.deserialize_ros1(data, known.msgtype)
                message.data = np.full_like(message.data, 1e30)
                data = types.serialize_ros1(message, known.msgtype)
            odd.write(connections[known.topic], time_ns, data)
    with pytest.raises(RecordingError) as refused:
        recording_of(read_run([path]))
    assert str(refused.value) == f"{path}: /voice_map/values: values up to 1e+30; expected at most 10000"


def test_infinite_ranges_are_drawn_to_the_end_of_the_laser_and_too_near_ones_as_0() -> None:
    ranges_m = np.array([1.5, np.inf, -np.inf, np.nan], dtype=np.float32)
    assert finite_ranges(ranges_m, FAR_M) == [1.5, FAR_M, 0.0, FAR_M]


@pytest.mark.slow
def test_links_of_a_bag_without_one_robot_join_the_robots_of_their_numbers(
    hall_scenario: Callable[..., Scenario], tmp_path: Path
) -> None:
    simulation = Simulation(hall_scenario())
    simulation.run([BagWriter(tmp_path / "mission.bag")])
    run = read_run([tmp_path / "mission.bag"])
    without = dataclasses.replace(run, robots=run.robots[1:])
    assert any(frame.links for frame in recording_of(run).frames)
    shown = recording_of(without)
    assert not any(frame.links for frame in shown.frames)
    assert [(robot.number, robot.colour) for robot in shown.scene.robots] == [(1, palette.robot_colour(1))]


@pytest.mark.slow
def test_recording_of_more_than_a_day_is_rejected(hall_scenario: Callable[..., Scenario], tmp_path: Path) -> None:
    path = tmp_path / "mission.bag"
    Simulation(hall_scenario()).run([BagWriter(path)])
    run = read_run([path])
    with pytest.raises(RecordingError, match=r"mission\.bag: lasts 172800 s by its stamps; expected at most 86400 s"):
        recording_of(dataclasses.replace(run, end_ns=run.start_ns + 172_800 * 10**9))
    long = recording_of(dataclasses.replace(run, end_ns=run.start_ns + 40_000 * 10**9))
    assert len(long.frames) == MOST_FRAMES + 1


def test_doors_that_a_bag_does_not_contain_are_those_of_the_scenario(tmp_path: Path) -> None:
    scenario, path = load("garage_sar", ["mission.time_limit_s=2"]), tmp_path / "mission.bag"
    Simulation(scenario).run([BagWriter(path)])
    run = read_run([path])
    expected = tuple(0.0 if door.closed else 1.0 for door in scenario.plan.doors)
    assert {0.0, 1.0} == set(expected)
    assert {frame.doors for frame in recording_of(run, scenario).frames} == {expected}
