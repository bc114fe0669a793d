#!/usr/bin/env python3
"""Drives robots by cmd_vel and calls every service."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import math
import unittest

import rospy
import rostest
from geometry_msgs.msg import Point, Twist, Vector3
from listening import Topic, call, latched_time, pause, place_m, reset, speed_mps
from nav_msgs.msg import Odometry
from robotteamsim.msg import FloatMap, MissionEvent, MissionStatus, Victims
from robotteamsim.srv import SetDoor, SetNoise, SetVictim, Step
from rosgraph_msgs.msg import Log
from std_srvs.srv import Empty, Trigger

FORWARD = Twist(linear=Vector3(0.5, 0.0, 0.0))
HOLD_S = 0.8


def stamp_s(message: Odometry) -> float:
    return message.header.stamp.to_sec()


def turned_rad(message: Odometry) -> float:
    turn = message.pose.pose.orientation
    return 2.0 * math.atan2(turn.z, turn.w)


class CommandsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("commands_test", disable_rostime=True)
        cls.command = rospy.Publisher("/robot_0/cmd_vel", Twist, queue_size=0)
        cls.truth = Topic("/robot_0/base_pose_ground_truth", Odometry)
        cls.other = Topic("/robot_1/base_pose_ground_truth", Odometry)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.victims = Topic("/mission/victims", Victims)
        cls.events = Topic("/mission/events", MissionEvent)
        cls.voice_map = Topic("/voice_map/values", FloatMap)
        cls.log = Topic("/rosout", Log)
        cls.first = cls.truth.wait_for_count(1)[0]
        cls.status.wait_for_count(1)

    def setUp(self) -> None:
        self.truth.wait_for(lambda message: abs(speed_mps(message)) < 1e-3, "a robot that stands")

    def test_command_holds_for_its_time_and_then_the_robot_stops(self) -> None:
        begin = len(self.truth.messages)
        self.command.publish(FORWARD)
        moving = self.truth.wait_for_after(begin, lambda message: speed_mps(message) > 0.01, "a robot that moves")
        self.truth.wait_for(lambda message: speed_mps(message) < 0.01, "a robot that stands again")
        fast = [message for message in self.truth.messages[begin:] if speed_mps(message) > 0.49]
        # Of the eight steps of the hold, speeding up at 2 m/s^2 takes two and a half.
        self.assertAlmostEqual(stamp_s(fast[-1]) - stamp_s(moving), HOLD_S - 0.1, delta=0.11)

    def test_robot_turns_to_the_left_by_a_positive_command(self) -> None:
        before = turned_rad(self.truth.next())
        self.command.publish(Twist(angular=Vector3(0.0, 0.0, 0.5)))
        self.truth.wait_for(lambda message: turned_rad(message) > before + 0.1, "a robot that has turned")

    def test_command_of_one_robot_does_not_move_the_other(self) -> None:
        before = place_m(self.other.next())
        self.command.publish(FORWARD)
        self.truth.wait_for(lambda message: speed_mps(message) > 0.4, "a robot that moves")
        self.assertEqual(place_m(self.other.next()), before)

    def test_command_that_is_not_finite_is_ignored_with_a_warning_once_a_second(self) -> None:
        begin, place = len(self.log.messages), place_m(self.truth.next())
        for bad in (math.nan, math.inf, -math.inf):
            for _ in range(10):
                self.command.publish(Twist(linear=Vector3(bad, 0.0, 0.0)))
        warning = self.log.wait_for_after(begin, lambda message: "not finite" in message.msg, "a warning")
        self.assertEqual(warning.level, Log.WARN)
        self.assertIn("robot_0", warning.msg)
        later = self.truth.messages[-1].header.stamp.to_sec() + 1.0
        self.assertEqual(place_m(self.truth.wait_for(lambda message: stamp_s(message) > later, "a later stamp")), place)
        warnings = [message for message in self.log.messages[begin:] if "not finite" in message.msg]
        self.assertLessEqual(len(warnings), 2)

    def test_reset_positions_puts_robots_back_while_time_goes_on(self) -> None:
        self.command.publish(FORWARD)
        away = self.truth.wait_for(lambda message: place_m(message)[0] > place_m(self.first)[0] + 0.1, "a robot away")
        call("/reset_positions", Empty)
        start = place_m(self.first)
        back = self.truth.wait_for(lambda message: math.dist(place_m(message), start) < 0.09, "a robot at its start")
        self.assertGreater(stamp_s(back), stamp_s(away))

    def test_paused_world_stops_steps_on_request_and_resumes(self) -> None:
        self.assertFalse(call("/simulation/step", Step, steps=1).success)
        before = pause(self.truth)
        self.assertFalse(call("/simulation/step", Step, steps=0).success)
        self.assertTrue(call("/simulation/step", Step, steps=3).success)
        self.assertEqual((latched_time() - before).to_nsec(), 300_000_000)
        self.truth.wait_for_step(latched_time())
        self.assertTrue(call("/simulation/resume", Trigger).success)
        self.truth.wait_for(lambda message: message.header.stamp > before + rospy.Duration(1), "a later stamp")

    def test_reset_restarts_every_node(self) -> None:
        self.command.publish(FORWARD)
        self.truth.wait_for(lambda message: speed_mps(message) > 0.4, "a robot that moves")
        self.assertTrue(call("/simulation/reset", Trigger).success)
        begin = len(self.truth.messages)
        reset(self.truth, self.status)
        fresh = self.truth.wait_for_after(begin, lambda message: stamp_s(message) < 1.0, "a stamp near zero")
        self.assertEqual(place_m(fresh), place_m(self.first))
        later = self.status.wait_for(lambda message: message.header.stamp.to_sec() > 1.0, "a later stamp")
        self.assertEqual(later.state, "running")
        self.assertLessEqual(later.time_s, later.header.stamp.to_sec())

    def test_doors_noise_and_victims_are_changed_by_service(self) -> None:
        refused = call("/simulation/set_door", SetDoor, name="no_such_door", closed=True)
        self.assertFalse(refused.success)
        self.assertIn("no_such_door", refused.message)
        self.assertTrue(call("/simulation/set_door", SetDoor, name="plant_door", closed=True).success)
        self.events.wait_for_after(
            0, lambda message: (message.kind, message.subject) == ("door", "plant_door"), "the door"
        )
        self.assertFalse(call("/simulation/set_noise", SetNoise, noise_db=99.0).success)
        refused = call("/simulation/set_victim", SetVictim, name="eve", position=Point(-5.0, 0.0, 0.0))
        self.assertFalse(refused.success)
        begin = len(self.voice_map.messages)
        self.assertTrue(call("/simulation/set_noise", SetNoise, noise_db=25.0).success)
        self.status.wait_for(lambda message: message.noise_db == 25.0, "the new noise")
        self.voice_map.wait_for_after(begin, lambda message: min(filter(None, message.data)) > 0.0, "a new map")
        self.assertTrue(call("/simulation/set_victim", SetVictim, name="eve", position=Point(6.0, 5.0, 0.0)).success)
        self.victims.wait_for_after(0, lambda message: "eve" in [victim.name for victim in message.victims], "eve")

    def test_invalid_change_is_rejected(self) -> None:
        refusals = (
            call("/simulation/set_noise", SetNoise, noise_db=math.nan),
            call("/simulation/set_door", SetDoor, name="no_such_door", closed=True),
            call("/simulation/set_victim", SetVictim, name="eve", position=Point(math.nan, 0.0, 0.0)),
        )
        self.assertEqual([refused.success for refused in refusals], [False] * 3)
        self.assertTrue(math.isfinite(self.status.next().noise_db))

    def test_victims_are_added_while_the_mission_goes_on(self) -> None:
        # They come while the node publishes: a status from before beside the victims of after would end it.
        names = [f"caller_{index}" for index in range(40)]
        set_victim = rospy.ServiceProxy("/simulation/set_victim", SetVictim, persistent=True)
        for name in names:
            self.status.next()
            self.assertTrue(set_victim(name=name, position=Point(6.0, 5.0, 0.0)).success)
        set_victim.close()
        self.victims.wait_for_after(
            0, lambda message: set(names) <= {victim.name for victim in message.victims}, "all who called"
        )
        self.status.next()
        begin = len(self.victims.messages)
        call("/simulation/reset", Trigger)
        self.victims.wait_for_after(begin, lambda message: len(message.victims) == 4, "the scenario's victims")

    def test_mission_is_paused_resumed_aborted_and_begun_again(self) -> None:
        self.assertTrue(call("/mission/pause", Trigger).success)
        self.status.wait_for(lambda message: message.state == "paused", "state paused")
        self.assertFalse(call("/mission/start", Trigger).success)
        self.assertTrue(call("/mission/resume", Trigger).success)
        self.status.wait_for(lambda message: message.state == "running", "state running")
        self.assertTrue(call("/mission/abort", Trigger).success)
        ended = self.status.wait_for(lambda message: message.state == "ended", "state ended")
        self.assertEqual(ended.end, "aborted")
        call("/simulation/reset", Trigger)
        self.status.wait_for(lambda message: message.state == "running", "state running")


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "commands", CommandsTest)
