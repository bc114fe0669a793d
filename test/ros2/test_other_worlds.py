"""Robots of another world: their poses by ground truth or by tf, and who has lost them."""

from __future__ import annotations

import sys
from contextlib import ExitStack

import pytest
from outside import Outside
from peer import ALL_LATCHED, MISSION
from running import running

from robotteamsim.scenario import load
from robotteamsim.setup import resolve

ROBOTS = ("robots.count=2",)
TF = ("control.localisation=tf", "control.tf_timeout_s=0.5")
ELSEWHERE = ("--ros-args", "-p", "elsewhere:=all")


def mission(*overrides):
    changes = [part for override in (*ROBOTS, *overrides) for part in ("--set", override)]
    return (*MISSION, "garage_sar", *changes, "--controllers", "team", "--localization", "none", *ELSEWHERE)


@pytest.mark.parametrize("overrides", [(), TF], ids=["ground truth", "tf"])
def test_controllers_drive_robots_of_another_world_whose_sensors_are_best_effort(tmp_path, peer, overrides):
    setup = resolve(load("garage_sar", ROBOTS))
    commands = peer.listen("/robot_1/cmd_vel", "geometry_msgs/Twist")
    states = peer.listen("/mission/status", "robotteamsim/MissionStatus", ALL_LATCHED)
    voices = peer.listen("/robot_1/voice", "robotteamsim/Voice")
    with running(mission(*overrides), tmp_path) as found, Outside(peer, setup, has_truth=not overrides):
        peer.wait_until(lambda: any(state.time_s > 2.0 for state in states), "a mission that goes on")
        peer.wait_until(lambda: any(command.linear.x > 0.1 for command in commands), "a command")
        # A robot that hears nothing is its own local best.
        place = peer.wait_until(lambda: voices, "a voice")[-1].local_best
        assert (place.x, place.y) == pytest.approx(setup.robots[1].start_pose[:2])
    assert "Traceback" not in found.output


def test_robot_that_tf_has_lost_is_stopped_and_found_again(tmp_path, peer):
    statuses = peer.listen("/robot_1/controller/status", "robotteamsim/ControllerStatus")
    events = peer.listen("/mission/events", "robotteamsim/MissionEvent")
    line = "/tf: no transform map -> robot_1/base_link for 0.5 s (control.tf_timeout_s)"
    with ExitStack() as stack:
        stack.enter_context(running(mission(*TF), tmp_path))
        outside = stack.enter_context(Outside(peer, resolve(load("garage_sar", ROBOTS)), has_truth=False))
        peer.wait_until(lambda: statuses and not statuses[-1].fault, "a robot that is located")
        outside.located.remove(1)
        peer.wait_until(lambda: statuses[-1].fault == line, "a fault")
        peer.wait_until(lambda: any(event.kind == "controller_failed" for event in events), "an event")
        outside.located.add(1)
        peer.wait_until(lambda: not statuses[-1].fault, "a robot that is found")


def test_robot_that_is_not_located_is_named(tmp_path, peer):
    with ExitStack() as stack:
        found = stack.enter_context(running(mission(*TF), tmp_path))
        outside = stack.enter_context(Outside(peer, resolve(load("garage_sar", ROBOTS)), has_truth=False))
        outside.located.remove(1)
        reason = "to publish map -> odom and the robot odom -> base_link (no transform leads to robot_1/odom)"
        wanted = f"/tf: waited 10 s for map -> robot_1/base_link; expected a localisation node such as amcl {reason}"
        found.wait_for(lambda text: wanted in text, "the missing transform")


def test_schedule_of_another_world_needs_its_clock(tmp_path, peer):
    simulation = (sys.executable, "-m", "robotteamsim.ros2.simulation", *ELSEWHERE, "-p", "scenario:=garage_sar")
    schedule = 'set:=control.localisation=tf schedule=[{"at_s":9.0,"noise_db":20.0}]'
    with running((*simulation, "-p", schedule), tmp_path) as node:
        assert node.wait() == 2, node.output
    assert "/use_sim_time: false; expected true, because the scenario has a schedule" in node.output


def test_own_world_locates_robots_by_its_own_tf(tmp_path, peer):
    statuses = peer.listen("/robot_0/controller/status", "robotteamsim/ControllerStatus")
    command = (*MISSION, "tutorial_arena", "--set", "control.localisation=tf", "--set", "mission.time_limit_s=20")
    with running((*command, "--speed", "5"), tmp_path) as found:
        assert found.wait() == 0, found.output
    assert any(status.has_goal for status in statuses)
    assert not any(status.fault for status in statuses)
