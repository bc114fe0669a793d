"""Robots map the office on the paths of a short mission, from their odometry and lasers alone."""

import dataclasses

import numpy as np
import pytest

from study.unknown.mapping import LASERS, Outcome, mapped
from study.unknown.recording import measured_again, record

MISSION = (
    "office_manet",
    "control.c4=0",
    "robots.count=3",
    "mission.time_limit_s=120",
    "run.seed=1",
    *(f"robots.laser.{key}" for key in LASERS["long"]),
)


@pytest.fixture(scope="module")
def outcome() -> Outcome:
    return mapped(MISSION, robot_id=1, seed=1, noise_m=0.01)


@pytest.mark.slow
def test_occupied_cells_are_near_true_walls(outcome: Outcome) -> None:
    assert outcome.share >= 0.95
    assert outcome.aligned_share >= 0.95
    assert outcome.worst_m < 0.1
    assert 0.1 < outcome.coverage < 1.0
    assert outcome.submaps > 2
    assert outcome.lost_updates == 0


@pytest.mark.slow
def test_same_seed_gives_the_same_map(outcome: Outcome) -> None:
    again = mapped(MISSION, robot_id=1, seed=1, noise_m=0.01)
    assert dataclasses.replace(again, update_ms=outcome.update_ms) == outcome


@pytest.mark.slow
def test_robots_measure_the_odometry_of_their_noise() -> None:
    recording = record(*MISSION)
    ends = [list(measured_again(recording, 1, seed, 0.0))[-1].odometry for seed in (1, 2, 1)]
    assert ends[0] == ends[2] != ends[1]
    start, truth = recording.poses[0, 1], recording.poses[-1, 1]
    travelled_m = np.hypot(*(truth - start)[:2])
    assert np.hypot(ends[0].x_m, ends[0].y_m) == pytest.approx(travelled_m, rel=0.2)  # `odom` begins at the start
