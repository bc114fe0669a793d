"""A robot that is not where it believes to be: what its controller learns."""

import math

import numpy as np
import pytest

from robotteamsim.control.runtime.located import Located
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.interface import Decision, Observation, Task
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading

TRUE, BELIEVED = Pose(3.0, 4.0, 0.5 * math.pi), Pose(10.0, 0.0, 0.0)


class _Fixed:
    def pose(self, observation):
        return BELIEVED


class _Kept:
    def step(self, observation, inbox, task):
        self.observation = observation
        return Decision()


@pytest.fixture
def observation():
    """Return what the controller of a robot at TRUE gets that believes to be at BELIEVED."""
    reading = PoseReading.from_pose(TRUE)
    robot = RobotReading(reading, Twist(), OdometryReading(reading, Twist()), np.zeros(0, np.float32), in_contact=False)
    kept = _Kept()
    # The voice is 2 m ahead and 1 m to the left.
    located = Located(kept, _Fixed())
    located.step(Observation(0, 10**8, robot, VoiceReading(20.0, True, (2.0, 6.0), 25.0)), (), Task())
    return kept.observation


def test_its_pose_is_the_believed_one_everywhere(observation):
    assert observation.pose == BELIEVED
    assert observation.robot.true_pose == BELIEVED


def test_it_hears_a_voice_where_it_is_as_seen_from_the_robot(observation):
    assert observation.voice.local_best_m == pytest.approx((12.0, 1.0))
    assert observation.voice.local_best_level_db == 25.0
