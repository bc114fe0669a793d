from __future__ import annotations

import pytest

from robotteamsim.geometry import Twist
from robotteamsim.nodes import answers
from robotteamsim.nodes.answers import STOP, CommandsByTopic
from robotteamsim.scenario.sections import PlacedRobot

FORWARD, TURN = Twist(0.5), Twist(0.0, 0.0, 0.3)


class Team:
    """Robots that hold their commands for 800 ns and 100 ns, driven by the topics of their ids."""

    controllers, lockstep = "nodes", False

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._receivers = {}
        monkeypatch.setattr(answers, "Input", self)
        robots = [PlacedRobot(start_pose=(0.0, 0.0, 0.0), cmd_vel_hold_s=hold_s) for hold_s in (800e-9, 100e-9)]
        self.commands = CommandsByTopic(None, self, robots)

    def of(self, _, __, ___, robot_id):
        self._robot_id = robot_id
        return self

    def listen(self, receive, _):
        self._receivers[self._robot_id] = receive

    def send(self, robot_id, twist):
        self._receivers[robot_id]("cmd_vel", 0, twist)


@pytest.fixture
def team(monkeypatch):
    return Team(monkeypatch)


def test_command_holds_from_the_next_step_for_its_time_and_then_the_robot_stops(team):
    assert team.commands.at(0) == {0: STOP, 1: STOP}
    team.send(0, FORWARD)
    assert [team.commands.at(time_ns)[0] for time_ns in (1000, 1799, 1800)] == [FORWARD, FORWARD, STOP]


def test_commands_of_robots_do_not_mix(team):
    team.send(0, FORWARD)
    team.send(1, TURN)
    assert team.commands.at(0) == {0: FORWARD, 1: TURN}
    assert team.commands.at(99) == {0: FORWARD, 1: TURN}
    assert team.commands.at(100) == {0: FORWARD, 1: STOP}


def test_command_of_one_robot_does_not_let_that_of_another_hold_on(team):
    team.send(0, FORWARD)
    team.commands.at(0)
    team.send(1, TURN)
    assert team.commands.at(750) == {0: FORWARD, 1: TURN}
    assert team.commands.at(800) == {0: STOP, 1: TURN}


def test_stopped_robot_has_no_command(team):
    team.send(0, FORWARD)
    team.send(1, TURN)
    team.commands.stop(0)
    assert team.commands.at(0) == {0: STOP, 1: TURN}
