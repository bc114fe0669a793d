from __future__ import annotations

import math

import pytest

from robotteamsim.geometry import Twist
from robotteamsim.ros.commands import STOP, Commands

FORWARD = Twist(0.5, 0.0, 0.1)


def test_command_holds_for_its_time_and_then_the_robot_stops():
    commands = Commands([800])
    assert commands.at(0, 0) == STOP
    commands.put(0, 1000, FORWARD)
    assert commands.at(0, 1000) == FORWARD
    assert commands.at(0, 1799) == FORWARD
    assert commands.at(0, 1800) == STOP


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_command_that_is_not_finite_is_ignored_and_the_one_before_holds_on(bad):
    commands = Commands([800])
    commands.put(0, 0, FORWARD)
    assert not commands.put(0, 700, Twist(0.0, 0.0, bad))
    assert commands.at(0, 700) == FORWARD
    assert commands.at(0, 800) == STOP


def test_commands_of_robots_do_not_mix():
    commands = Commands([800, 100])
    commands.put(1, 0, FORWARD)
    assert (commands.at(0, 50), commands.at(1, 50), commands.at(1, 100)) == (STOP, FORWARD, STOP)


def test_command_of_one_robot_does_not_let_that_of_another_hold_on():
    commands = Commands([800, 800])
    commands.put(0, 0, FORWARD)
    commands.put(1, 700, FORWARD)
    assert (commands.at(0, 900), commands.at(1, 900)) == (STOP, FORWARD)


def test_stopped_robot_has_no_command():
    commands = Commands([800, 800])
    commands.put(0, 0, FORWARD)
    commands.put(1, 0, FORWARD)
    commands.stop(0)
    assert (commands.at(0, 1), commands.at(1, 1)) == (STOP, FORWARD)
