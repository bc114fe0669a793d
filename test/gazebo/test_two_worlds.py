"""Two robots in our own world and one in Gazebo search the garage together [dissertation, sec. 5.3]."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from recorded import Recording, scans_m
from running import ROSLAUNCH, running

from robotteamsim.scenario import load
from robotteamsim.setup import resolve

ROBOTS = range(3)
LIMIT_S = 120
DIAMETER_M = 0.4


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, gazebo: tuple[str, ...]) -> tuple[Recording, dict[str, Any]]:
    folder = tmp_path_factory.mktemp("two_worlds")
    arguments = ("in_gazebo:=2", f"set:=mission.time_limit_s={LIMIT_S}", "speed:=2", "rviz:=false")
    outputs = ("record:=true", "bag:=run.bag", "out:=results")
    with running((*ROSLAUNCH, "robotteamsim", "scenario.launch", *arguments, *outputs, *gazebo), folder) as program:
        assert program.wait(600.0) == 0, program.output
    result = json.loads((folder / "results" / "mission.json").read_text())["result"]
    return Recording(folder / "run.bag", len(ROBOTS)), result


def common_stamps(recording: Recording) -> list[int]:
    stamps = [set(recording.of(i, name)) for i in ROBOTS for name in ("base_scan", "base_pose_ground_truth")]
    return sorted(set.intersection(*stamps))


def test_all_robots_drive_and_explore_together(run: tuple[Recording, dict[str, Any]]) -> None:
    recording, result = run
    for robot_id in ROBOTS:
        steps_m = np.diff(recording.track_m(robot_id), axis=0)
        assert np.hypot(*steps_m.T).sum() > 10.0
    assert result["areas_explored"] + result["victims_saved"] >= 1


def test_each_robot_sees_those_of_the_other_world(run: tuple[Recording, dict[str, Any]]) -> None:
    recording, _ = run
    scenario = load("garage_sar")
    stamp = common_stamps(recording)[0]  # they have not moved yet
    measured = np.array([recording.of(i, "base_scan")[stamp].ranges for i in ROBOTS])
    low, _, high = scans_m(scenario, resolve(scenario).robots, [recording.pose(i, stamp) for i in ROBOTS])
    assert ((measured > low - 0.02) & (measured < high + 0.02)).all()


def test_robots_do_not_drive_through_those_of_the_other_world(run: tuple[Recording, dict[str, Any]]) -> None:
    recording, _ = run
    poses = np.array([[recording.pose(i, stamp)[:2] for i in ROBOTS] for stamp in common_stamps(recording)])
    for other in (0, 1):
        distances_m = np.hypot(*(poses[:, 2] - poses[:, other]).T)
        # Each world knows the other one's robots from the step before.
        assert distances_m.min() > 0.75 * DIAMETER_M
