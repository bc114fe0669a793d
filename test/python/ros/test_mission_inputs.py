"""What the mission node makes of the messages of one robot."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from robotteamsim.msg import ControllerStatus, TeamState

from robotteamsim.ros.nodes.mission import RobotInputs
from robotteamsim.ros.transport.presence import Presence
from robotteamsim.ros.transport.synchronizer import Step
from robotteamsim.ros.transport.team_poses import TEAM_STATE, TruePoses, WorldPoses


def step(*statuses: ControllerStatus) -> Step:
    return Step(100, False, {"/robot_0/controller/status": statuses})


@pytest.mark.parametrize(("lockstep", "swarms"), [(False, [0, 3, 3, 0]), (True, [0, 3, 0, 0])])
def test_decision_without_lockstep_is_the_newest_one(lockstep, swarms):
    robot = RobotInputs(0, TruePoses(1), SimpleNamespace(lockstep=lockstep, team_state=False))
    found = [robot.decision(step()), robot.decision(step(ControllerStatus(swarm=3))), robot.decision(step())]
    robot.forget()
    found.append(robot.decision(step()))
    assert [decision.swarm for decision in found] == swarms


def test_poses_and_contacts_of_all_robots_come_in_one_message():
    poses = WorldPoses(2)
    robots = [RobotInputs(i, poses, SimpleNamespace(lockstep=True, team_state=True)) for i in (0, 1)]
    assert not robots[1].inputs(False)
    state = TeamState(poses=[1.0, 2.0, 0.0, 1.0] * 2, twists=[0.0] * 6, in_contact=bytes([0, 1]))
    received = Step(100, False, {TEAM_STATE: (state,)})
    assert poses.follow(received, Presence())
    assert [robot.reading(received).in_contact for robot in robots] == [False, True]
