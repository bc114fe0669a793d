from __future__ import annotations

import os

import numpy as np
import pytest

from robotteamsim.errors import RecordingError
from robotteamsim.geometry import PoseReading
from robotteamsim.recording import TumWriter
from robotteamsim.recording.trajectories import TUM_HEADER, tum_line
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation


def test_tum_line_has_time_position_and_quaternion():
    pose = PoseReading(1.5, -2.0, 0.6, 0.8)
    assert tum_line(12_300_000_000, pose) == "12.300000000 1.5 -2.0 0 0 0 0.6 0.8"


def test_one_file_per_robot_with_one_line_per_step(trial, tmp_path):
    trial.play(TumWriter(tmp_path / "trajectories"), steps=4)
    assert sorted(os.listdir(tmp_path / "trajectories")) == ["robot_0.tum", "robot_1.tum"]
    lines = (tmp_path / "trajectories" / "robot_1.tum").read_text().splitlines()
    assert lines[0] == TUM_HEADER
    assert len(lines) == 5


def test_robots_of_a_mission_before_are_not_among_those_of_this_one(trial, tmp_path):
    for name in ("robot_1.tum", "robot_2.tum", "robot_2.tum.old", "robot_mine.tum"):
        (tmp_path / name).write_text("old")
    trial.play(TumWriter(tmp_path), steps=4)
    assert sorted(os.listdir(tmp_path)) == ["robot_0.tum", "robot_1.tum", "robot_2.tum.old", "robot_mine.tum"]


def test_numbers_read_back_are_the_same_bits(trial, tmp_path):
    trial.play(TumWriter(tmp_path), steps=4)
    columns = np.loadtxt(tmp_path / "robot_1.tum")
    truth = [record.readings[1].ground_truth for record in trial.records(4)]
    expected = [[0.1 * (i + 1), p.x_m, p.y_m, 0, 0, 0, p.qz, p.qw] for i, p in enumerate(truth)]
    np.testing.assert_array_equal(columns[:, 1:], np.array(expected)[:, 1:])
    np.testing.assert_allclose(columns[:, 0], np.array(expected)[:, 0])


def test_broken_off_trial_leaves_no_trajectory(trial, tmp_path):
    writer = TumWriter(tmp_path)
    writer.begin(trial.setup)
    writer.step(trial.record(1))
    writer.abandon()
    assert os.listdir(tmp_path) == []


def test_unwritable_folder_is_rejected_at_the_beginning(trial, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match="file/deeper: cannot be written: Not a directory"):
        TumWriter(tmp_path / "file" / "deeper").begin(trial.setup)


def test_robot_that_is_not_there_has_no_line(tmp_path):
    schedule = "schedule=[{at_s: 0.3, remove: 1}, {at_s: 0.6, spawn: 1}]"
    Simulation(load("garage_sar", [schedule, "mission.time_limit_s=0.9"])).run([TumWriter(tmp_path)])
    stamps_s = np.loadtxt(tmp_path / "robot_1.tum")[:, 0]
    np.testing.assert_allclose(stamps_s[:5], [0.1, 0.2, 0.3, 0.7, 0.8])
