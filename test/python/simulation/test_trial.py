from __future__ import annotations

import hashlib
import math
import struct

import numpy as np
import pytest

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.rng import stream
from robotteamsim.sensing.readings import OdometryReading, RobotReading, state_of
from robotteamsim.simulation.trial import TeamTotals, TrajectoryHash

POSE = (1.5, -2.25, 0.6, 0.8)
STILL = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())


def update(figures, positions_m, in_contact, excluded, running):
    """Take in one step."""
    robots = [
        RobotReading(PoseReading(x_m, y_m, 0.0, 1.0), Twist(), STILL, np.zeros(0, np.float32), touches)
        for (x_m, y_m), touches in zip(positions_m, in_contact, strict=True)
    ]
    figures.update(state_of(robots), excluded, running)


def walk_along_x(figures, xs_m, running=True):
    for x_m in xs_m:
        update(figures, [(x_m, 0.0)], [False], [False], running)


def test_distance_contact_and_exclusion_are_added_up_per_robot():
    figures = TeamTotals(2, step_s=0.2)
    for x in (0.0, 3.0, 3.0):
        update(figures, [(x, 0.0), (0.0, x)], [x > 0.0, False], [False, True], running=True)
    first, second = figures.result()
    assert (first.distance_m, second.distance_m) == (3.0, 3.0)
    assert (first.contact_s, second.contact_s) == (pytest.approx(0.4), 0.0)
    assert (first.excluded_s, second.excluded_s) == (0.0, pytest.approx(0.6))


def test_longest_stay_is_the_longest_time_within_half_a_metre_while_the_mission_runs():
    figures = TeamTotals(1, step_s=1.0)
    walk_along_x(figures, [0.0, 0.3, 0.4, 1.0, 1.2, 2.0])  # three steps near 0, two near 1, one at 2
    walk_along_x(figures, [2.0] * 10, running=False)
    assert figures.result()[0].longest_stay_s == 3.0


def test_robot_that_comes_elsewhere_has_no_path_between():
    figures = TeamTotals(1, step_s=1.0)
    walk_along_x(figures, (0.0, 3.0, math.nan, 10.0, 11.0))
    assert figures.result()[0].distance_m == 4.0


def test_nothing_counts_of_a_robot_that_is_not_there():
    figures = TeamTotals(1, step_s=1.0)
    for _ in range(3):
        update(figures, [(math.nan, math.nan)], [True], [True], running=True)
    assert figures.result()[0] == type(figures.result()[0])(0.0, 0.0, 0.0, 0.0)


def by_hand(path_m, in_contact, excluded, running):
    """Return the distance, and the steps in contact, excluded and of the longest stay, of one robot."""
    distance_m, stays = 0.0, [0]
    before_m = anchor_m = None
    for at_m, runs in zip(path_m, running, strict=True):
        if math.isnan(at_m[0]):
            before_m = anchor_m = None
            continue
        if before_m is not None:
            distance_m += math.dist(at_m, before_m)
        before_m = at_m
        if anchor_m is None or math.dist(at_m, anchor_m) > 0.5:
            anchor_m = at_m
            stays.append(0)
        stays[-1] += bool(runs)
    there = [not math.isnan(at_m[0]) for at_m in path_m]
    return distance_m, int(np.sum(in_contact & there)), int(np.sum(excluded & there)), max(stays)


def test_totals_of_random_walks_equal_the_sums_over_all_steps():
    generator = stream(3, "figures")
    steps, robots = 500, 4
    paths_m = np.cumsum(generator.normal(0.0, 0.15, (steps, robots, 2)), axis=0)
    paths_m[generator.random((steps, robots)) < 0.02] = math.nan
    in_contact, excluded = generator.random((2, steps, robots)) < 0.3
    running = generator.random(steps) < 0.9
    totals = TeamTotals(robots, step_s=1.0)
    for step in range(steps):
        update(totals, paths_m[step], in_contact[step], excluded[step].tolist(), bool(running[step]))
    for robot_id, figures in enumerate(totals.result()):
        distance_m, *counts = by_hand(
            paths_m[:, robot_id].tolist(), in_contact[:, robot_id], excluded[:, robot_id], running
        )
        assert figures.distance_m == distance_m
        assert [figures.contact_s, figures.excluded_s, figures.longest_stay_s] == counts


def test_rows_that_do_not_fit_the_team_are_rejected():
    with pytest.raises(ValueError, match="one row per robot"):
        update(TeamTotals(2, step_s=1.0), np.zeros((3, 2)), [False] * 3, [False, False], running=True)
    with pytest.raises(ValueError, match="one row per robot"):
        update(TeamTotals(2, step_s=1.0), np.zeros((2, 2)), [False] * 2, [False], running=True)


def test_hash_is_sha256_of_stamp_and_little_endian_poses():
    ours = TrajectoryHash()
    ours.update(100_000_000, np.array([POSE, POSE]))
    expected = struct.pack("<q4d4d", 100_000_000, *POSE, *POSE)
    assert ours.hexdigest() == ours.hexdigest() == hashlib.sha256(expected).hexdigest()


def test_one_bit_of_one_pose_changes_the_hash():
    one, other = TrajectoryHash(), TrajectoryHash()
    one.update(0, np.array([POSE]))
    other.update(0, np.array([(1.5000000000000002, *POSE[1:])]))
    assert one.hexdigest() != other.hexdigest()
