"""The state of a team as arrays and as a record of each robot."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest
from robotteamsim._core.sensing import Lasers, RangeLimits, TeamSensors
from robotteamsim._core.state import State
from robotteamsim._core.world import Fan, FanCaster

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading, state_of


def reading(robot_id: int, beams: int = 3) -> RobotReading:
    """Return a record in which no two numbers are equal."""
    number = iter(range(100 * robot_id, 100 * robot_id + 100)).__next__
    pose, twist = PoseReading(*(float(number()) for _ in range(4))), Twist(*(float(number()) for _ in range(3)))
    odometry = OdometryReading(
        PoseReading(*(float(number()) for _ in range(4))),
        Twist(*(float(number()) for _ in range(3))),
        tuple(float(number()) for _ in range(6)),
        tuple(float(number()) for _ in range(3)),
    )
    ranges_m = np.arange(beams, dtype=np.float32) + robot_id
    touches = robot_id == 1
    return RobotReading(
        pose, twist, odometry, ranges_m, touches, (0.5,) if touches else (), {"fix": 3} if touches else {}
    )


def test_records_of_robots_are_those_of_which_the_arrays_were_made():
    state = state_of([reading(0), reading(1)])
    again = state.readings()
    assert len(again) == len(state) == 2
    for robot_id, record in enumerate(again):
        expected = reading(robot_id)
        for name in ("ground_truth", "twist", "odometry", "in_contact", "contact_angles_rad", "sensors"):
            assert getattr(record, name) == getattr(expected, name), name
        assert record.ranges_m.tolist() == expected.ranges_m.tolist()
    assert state.true_pose[1].tolist() == [100.0, 101.0, 102.0, 103.0]
    assert state.positions_m[1].tolist() == [100.0, 101.0]
    assert state.odometry_pose_covariance[0].tolist() == [14.0, 15.0, 16.0, 17.0, 18.0, 19.0]


def test_robots_with_different_lasers_have_their_own_beams():
    state = state_of([reading(0, beams=2), reading(1, beams=4)])
    assert state.ranges_m.tolist() == [[0.0, 1.0, math.inf, math.inf], [1.0, 2.0, 3.0, 4.0]]
    assert [record.ranges_m.tolist() for record in state] == [[0.0, 1.0], [1.0, 2.0, 3.0, 4.0]]


def test_what_robots_hear_is_what_was_put_there():
    voices = [VoiceReading(21.5, True, (3.5, 4.5), 24.0), VoiceReading(0.0, False, (3.0, 6.0), 0.0)]
    state = state_of([reading(0), reading(1)], voices)
    assert state.voices() == voices
    assert state.voice_heard.tolist() == [True, False]


def test_arrays_of_a_state_outlive_it_and_cannot_be_changed():
    pose = state_of([reading(0)]).odometry_pose
    assert pose[0].tolist() == [7.0, 8.0, 9.0, 10.0]
    with pytest.raises(ValueError, match="read-only"):
        pose[0] = 0.0


def test_reading_without_additional_sensors_replaces_those_that_were_there():
    state = state_of([reading(0), reading(1)])
    state.put_reading(1, msgspec.structs.replace(reading(0), sensors={}))
    assert state[1].sensors == {}
    assert state.sensors == {}


def test_reading_that_is_wrong_changes_nothing():
    state = state_of([reading(0), reading(1)])
    for odd in ({"in_contact": np.array([1, 2])}, {"ranges_m": "far"}, {"contact_angles_rad": (None,)}):
        with pytest.raises((ValueError, TypeError)):
            state.put_reading(0, msgspec.structs.replace(reading(1), **odd))
    assert state[0].ground_truth == reading(0).ground_truth


def test_caster_of_another_fan_is_refused():
    view = {"angle_min_rad": 0.0, "angle_max_rad": 1.0, "forward_m": 0.0, "left_m": 0.0, "range_max_m": 5.0}
    few, many = Fan(beams=2, **view), Fan(beams=9, **view)
    limits = RangeLimits(range_min_m=0.0, range_max_m=5.0, too_near_m=0.0, no_return_m=5.0)
    lasers = Lasers(many, limits, [0], FanCaster(few, [], []))
    with pytest.raises(ValueError, match="its caster as many"):
        TeamSensors([lasers], [(0.0, 0.0, 0.0, 0.0)], 0.1, [False])


def test_robots_and_links_that_are_not_there_are_refused():
    state = State(2)
    with pytest.raises(IndexError, match="no such robot"):
        state[2]
    with pytest.raises(ValueError, match="no links"):
        _ = state.adjacency
    with pytest.raises(ValueError, match="more beams"):
        state.put_reading(0, reading(0))
