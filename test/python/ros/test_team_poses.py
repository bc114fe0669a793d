"""Poses of a team for environment and mission, from tables instead of topics and tf."""

from __future__ import annotations

import logging
import math
from typing import Any

import pytest
from robotteamsim.msg import Robots, TeamState

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.ros.transport import team_poses
from robotteamsim.ros.transport.presence import Presence
from robotteamsim.ros.transport.synchronizer import Step
from robotteamsim.ros.transport.team_poses import TEAM_STATE, TfPoses, WorldPoses
from robotteamsim.sensing.readings import OdometryReading

STEP_NS = 100_000_000
ODOMETRY = OdometryReading(PoseReading(0.5, 0.0, 0.0, 1.0), Twist(0.4, 0.0, 0.1))
TRUTH = OdometryReading(PoseReading(7.0, 8.0, 0.0, 1.0), Twist(0.39, 0.0, 0.1))


class Tf:
    """The newest transform of each frame."""

    def __init__(self) -> None:
        self.poses: dict[str, tuple[int, float, float, float]] = {}

    def newest(self, target: str, source: str) -> tuple[tuple[int, float, float, float] | None, str]:
        return self.poses.get(source), "" if source in self.poses else f"{source} does not exist. "

    def clear(self) -> None:
        self.poses.clear()


class Team:
    """Two robots, which publish odometry in each step, and what else is given."""

    def __init__(self) -> None:
        self.tf = Tf()
        self.poses = TfPoses(2, 0.3, self.tf)
        self.presence = Presence()
        self._steps = 0

    def step(self, located: tuple[int, ...] = (0, 1), **truths: Any) -> bool:
        """Take a step: `located` robots have a transform at its stamp; truths by name of the robot."""
        self._steps += 1
        stamp_ns = self._steps * STEP_NS
        for robot_id in located:
            self.tf.poses[f"robot_{robot_id}/base_link"] = (stamp_ns, 2.0 + robot_id, 3.0, 0.0)
        messages = {f"/robot_{robot_id}/odom": (ODOMETRY,) for robot_id in range(2)}
        messages |= {f"/{name}/base_pose_ground_truth": (truth,) for name, truth in truths.items()}
        return self.poses.follow(Step(stamp_ns, False, messages), self.presence)

    def x_m(self, robot_id: int) -> float:
        return self.poses.reading(robot_id).pose.x_m


@pytest.fixture
def team() -> Team:
    return Team()


def test_steps_follow_the_odometry_and_do_not_wait_for_the_ground_truth(team):
    needed = {an_input.channel.name: an_input.channel.needed for an_input in team.poses.inputs(1)}
    assert needed == {"/robot_1/odom": True, "/robot_1/base_pose_ground_truth": False}


def test_pose_is_that_of_tf_and_the_twist_that_of_the_odometry(team):
    assert team.step()
    assert (team.x_m(0), team.x_m(1)) == (2.0, 3.0)
    assert team.poses.reading(0).twist == ODOMETRY.twist


def test_ground_truth_comes_first_while_it_is_published(team):
    assert team.step(located=(0,), robot_1=TRUTH)
    assert (team.x_m(0), team.poses.reading(1)) == (2.0, TRUTH)
    for _ in range(2):
        team.step()
        assert team.x_m(1) == 7.0
    team.step()  # 0.3 s without it
    assert team.x_m(1) == 3.0


def test_team_is_not_located_before_all_present_robots_are(team):
    assert not team.step(located=(0,))
    assert team.step(located=(0, 1))
    team.poses.restart()
    assert not team.step(located=(0,))
    team.presence.present = [True, False]
    assert team.step(located=(0,))


def test_transform_that_does_not_arrive_is_reported_once_after_10_s(team, monkeypatch, caplog):
    now_s = [100.0]
    monkeypatch.setattr(team_poses.time, "monotonic", lambda: now_s[0])
    with caplog.at_level(logging.WARNING):
        for now_s[0] in (100.0, 105.0, 110.0, 130.0):
            team.step(located=(0,))
    assert [record.getMessage() for record in caplog.records] == [
        "/tf: waited 10 s for map -> robot_1/base_link; expected a localisation node such as amcl to publish map -> "
        "odom and the robot odom -> base_link (robot_1/base_link does not exist.)"
    ]


def test_lost_robot_stays_at_its_last_place_and_is_named_once(team):
    team.step()
    lines = []
    for _ in range(5):
        assert team.step(located=(0,))
        lines += team.poses.newly_lost()
    assert lines == [
        "/tf: no transform map -> robot_1/base_link for 0.3 s (control.tf_timeout_s); using its last position"
    ]
    assert (team.x_m(0), team.x_m(1)) == (2.0, 3.0)


def world_step(x_m: list[float], present: list[int]) -> Step:
    poses = [number for x in x_m for number in (x, 3.0, 0.0, 1.0)]
    state = TeamState(poses=poses, twists=[0.5, 0.0, 0.1] * len(x_m), in_contact=bytes(len(x_m)))
    robots = Robots(present=bytes(present), arrivals=[1] * len(x_m))
    return Step(STEP_NS, False, {TEAM_STATE: (state,), "/world/robots": (robots,)})


def test_world_publishes_all_poses_in_one_message():
    poses, presence = WorldPoses(2), Presence()
    assert [an_input.channel.name for an_input in poses.team_inputs] == [TEAM_STATE]
    assert not poses.inputs(0)
    assert poses.follow(world_step([1.0, 2.0], [1, 1]), presence)
    assert poses.reading(1) == OdometryReading(PoseReading(2.0, 3.0, 0.0, 1.0), Twist(0.5, 0.0, 0.1))


@pytest.mark.parametrize(("present", "known"), [([1, 0], True), ([1, 1], False)])
def test_step_without_the_pose_of_a_present_robot_is_left_out(present, known):
    poses, presence = WorldPoses(2), Presence()
    step = world_step([1.0, math.nan], present)
    presence.follow(step)
    assert poses.follow(step, presence) == known
