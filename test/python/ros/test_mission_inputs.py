"""What the mission node makes of the messages of one robot."""

from __future__ import annotations

import pytest
from robotteamsim.msg import ControllerStatus

from robotteamsim.ros.nodes.mission import RobotInputs
from robotteamsim.ros.transport.synchronizer import Step
from robotteamsim.ros.transport.team_poses import TruePoses


def step(*statuses: ControllerStatus) -> Step:
    return Step(100, False, {"/robot_0/controller/status": statuses})


@pytest.mark.parametrize(("lockstep", "swarms"), [(False, [0, 3, 3, 0]), (True, [0, 3, 0, 0])])
def test_decision_without_lockstep_is_the_newest_one(lockstep, swarms):
    robot = RobotInputs(0, TruePoses(1), lockstep)
    found = [robot.decision(step()), robot.decision(step(ControllerStatus(swarm=3))), robot.decision(step())]
    robot.forget()
    found.append(robot.decision(step()))
    assert [decision.swarm for decision in found] == swarms
