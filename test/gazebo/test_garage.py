"""The garage mission with Gazebo's bodies and lasers, and our controllers, radio, voice, network and mission."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from recorded import ROBOT_TOPICS, Recording, scans_m
from running import ROSLAUNCH, running

from robotteamsim.scenario import load
from robotteamsim.setup import resolve

ROBOTS = range(3)
STEP_NS = 100_000_000
MISSION_S = 1800.0
"""Longest duration of a mission [s, wall]."""
NEAR_M = 0.02
SAMPLES_NS = 2 * 10**9
"""Interval at which scans are compared."""


class Run:
    """What a mission has left behind."""

    def __init__(self, folder: Path, arguments: tuple[str, ...]) -> None:
        speed = os.environ.get("GAZEBO_SPEED", "4")
        outputs = ("record:=true", "bag:=run.bag", "out:=results", "rviz:=false", f"speed:={speed}")
        with running((*ROSLAUNCH, "robotteamsim", "scenario.launch", *outputs, *arguments), folder) as program:
            self.status = program.wait(MISSION_S)
            self.output = program.output
        self.recording = Recording(folder / "run.bag", len(ROBOTS))
        self.result = json.loads((folder / "results" / "mission.json").read_text())["result"]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, gazebo: tuple[str, ...]) -> Run:
    return Run(tmp_path_factory.mktemp("garage"), gazebo)


def test_mission_ends_by_itself_with_all_areas_explored_and_victims_saved(run: Run) -> None:
    assert run.status == 0
    print(f"{run.result['areas_explored']} areas, {run.result['victims_saved']} victims, {run.result['time_s']:.1f} s")
    assert run.result["areas_explored"] == 5
    assert run.result["victims_saved"] >= 2


def test_every_robot_drives(run: Run) -> None:
    for robot_id in ROBOTS:
        steps_m = np.diff(run.recording.track_m(robot_id), axis=0)
        assert np.hypot(*steps_m.T).sum() > 50.0


def test_all_readings_of_a_step_have_its_stamp(run: Run) -> None:
    for robot_id in ROBOTS:
        stamps = [sorted(run.recording.of(robot_id, name)) for name in ROBOT_TOPICS]
        # A recorder subscribes to one topic after the other.
        first, last = max(each[0] for each in stamps), min(each[-1] for each in stamps)
        common, *others = ([stamp for stamp in each if first <= stamp <= last] for each in stamps)
        assert all(each == common for each in others)
        assert all(stamp % STEP_NS == 0 for stamp in common)
        assert len(common) > 100


def test_scans_agree_with_ours_at_the_same_poses(run: Run) -> None:
    scenario = load("garage_sar")
    robots = resolve(scenario).robots
    stamps = set.intersection(*(set(run.recording.of(i, "base_scan")) for i in ROBOTS))
    stamps &= set.intersection(*(set(run.recording.of(i, "base_pose_ground_truth")) for i in ROBOTS))
    errors_m = []
    for stamp in sorted(stamp for stamp in stamps if stamp % SAMPLES_NS == 0):
        measured = np.array([run.recording.of(i, "base_scan")[stamp].ranges for i in ROBOTS])
        low, exact, high = scans_m(scenario, robots, [run.recording.pose(i, stamp) for i in ROBOTS])
        errors_m.append(np.abs(measured - exact))
        # A beam along a corner may pass it or hit it.
        assert (measured > low - NEAR_M).all()
        assert (measured < high + NEAR_M).all()
    share = np.mean(np.array(errors_m) < NEAR_M)
    print(f"{np.size(errors_m)} beams, {share:.5f} within 2 cm, median error {np.median(errors_m):.2e} m")
    assert len(errors_m) > 50
    assert share > 0.995
