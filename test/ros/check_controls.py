#!/usr/bin/env python3
"""Tries what other simulators of this kind get wrong, and the services that control the world."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import math
import unittest
from collections.abc import Sequence

import rospy
import rostest
from geometry_msgs.msg import Pose2D, Twist, Vector3
from listening import TIMEOUT_S, Topic, call, catch_up, drive, latched_time, place_m, reset, speed_mps
from nav_msgs.msg import OccupancyGrid, Odometry
from robotteamsim.msg import Areas, Doors, FloatMap, MissionStatus, Victims
from robotteamsim.srv import RemoveObject, ResetSeed, SetObject, SetPose, SetSpeed
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker, MarkerArray

FORWARD = Twist(linear=Vector3(0.5, 0.0, 0.0))
AT_WALL = Pose2D(10.0, 0.7, -math.pi / 2)
"""Half a metre before the south wall of the garage, facing it."""
SPEED = 4.0
LATCHED = {
    "/clock": Clock,
    "/map": OccupancyGrid,
    "/voice_map": OccupancyGrid,
    "/voice_map/values": FloatMap,
    "/mission/status": MissionStatus,
    "/mission/victims": Victims,
    "/mission/areas": Areas,
    "/world/doors": Doors,
}
"""What a late subscriber gets at once."""
ENDLESS = 1e-6
"""At this speed a step takes a day."""


def stamp_s(message: Odometry) -> float:
    return message.header.stamp.to_sec()


def places_m(message: MarkerArray) -> list[tuple[float, float]]:
    """Return where the objects are that a message shows."""
    return [(m.pose.position.x, m.pose.position.y) for m in message.markers if m.action == Marker.ADD]


class ControlsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("controls_test", disable_rostime=True)
        cls.commands = [rospy.Publisher(f"/robot_{i}/cmd_vel", Twist, queue_size=0) for i in (0, 1)]
        cls.truths = [Topic(f"/robot_{i}/base_pose_ground_truth", Odometry) for i in (0, 1)]
        cls.odometry = Topic("/robot_0/odom", Odometry)
        for topic in (*cls.truths, cls.odometry):
            topic.wait_for_count(1)
        cls.starts = [place_m(truth.messages[0]) for truth in cls.truths]

    def setUp(self) -> None:
        self.reset()
        for truth in self.truths:
            truth.wait_for(lambda message: abs(speed_mps(message)) < 1e-3, "a robot that stands")

    def reset(self) -> None:
        reset(*self.truths, self.odometry)

    def drive_on(self, robot_id: int, steps: int) -> Sequence[Odometry]:
        """Keep one robot's command alive for some steps and return its true motion."""
        return drive(self.commands[robot_id], FORWARD, self.truths[robot_id], steps)

    def measured_m(self) -> tuple[float, float]:
        """Return where robot 0 is by its odometry."""
        catch_up(self.odometry)
        return place_m(self.odometry.messages[-1])

    def test_robot_that_is_silent_stops_while_the_one_that_is_commanded_goes_on(self) -> None:
        self.commands[0].publish(FORWARD)
        self.truths[0].wait_for(lambda message: speed_mps(message) > 0.4, "a robot that moves")
        driven = self.drive_on(1, 24)
        self.assertAlmostEqual(speed_mps(self.truths[0].next()), 0.0, places=3)
        self.assertTrue(all(speed_mps(message) > 0.4 for message in driven[8:]))

    def test_odometry_does_not_move_while_a_wall_blocks_the_robot(self) -> None:
        self.assertTrue(call("/simulation/set_pose", SetPose, robot_id=0, pose=AT_WALL).success)
        self.drive_on(0, 20)
        before = self.measured_m()
        truth = self.drive_on(0, 20)
        self.assertEqual({round(speed_mps(message), 3) for message in truth}, {0.0})
        self.assertLess(math.dist(before, self.measured_m()), 1e-3)

    def test_reset_begins_odometry_at_its_origin_again(self) -> None:
        self.drive_on(0, 8)
        self.assertGreater(self.measured_m()[0], 0.05)
        begin = len(self.odometry.messages)
        self.reset()
        fresh = self.odometry.wait_for_after(begin, lambda message: stamp_s(message) < 0.3, "an early stamp")
        self.assertEqual(place_m(fresh), (0.0, 0.0))

    def test_robot_is_put_elsewhere_and_its_odometry_does_not_notice(self) -> None:
        self.assertTrue(
            call("/simulation/set_pose", SetPose, robot_id=0, pose=Pose2D(10.0, 3.0, 2.5 * math.pi)).success
        )
        there = self.truths[0].wait_for(lambda message: place_m(message) == (10.0, 3.0), "the new place")
        self.assertAlmostEqual(there.pose.pose.orientation.z, math.sqrt(0.5))
        self.assertEqual(place_m(self.odometry.next()), (0.0, 0.0))
        self.assertEqual(place_m(self.truths[1].next()), self.starts[1])

    def test_place_without_room_for_a_robot_is_rejected_with_the_reason(self) -> None:
        for robot_id, x_m, reason in (
            (2, 10.0, "robot_id must be in 0..1, got 2"),
            (0, -3.0, "robot_0: pose (-3.00, 0.20) is outside the plan"),
            (0, math.nan, "robot_0: pose must be finite"),
        ):
            refused = call("/simulation/set_pose", SetPose, robot_id=robot_id, pose=Pose2D(x_m, 0.2, 0.0))
            self.assertFalse(refused.success)
            self.assertIn(reason, refused.message)
            self.assertNotIn("\n", refused.message)
        self.assertEqual(place_m(self.truths[0].next()), self.starts[0])

    def test_objects_are_added_moved_and_removed_and_a_reset_takes_them_away(self) -> None:
        objects = Topic("/world/objects", MarkerArray)
        self.addCleanup(objects.unsubscribe)
        self.assertTrue(objects.is_connected(TIMEOUT_S))
        crate = {"name": "crate", "kind": "box", "length_m": 0.6, "width_m": 0.4}
        self.assertTrue(call("/simulation/set_object", SetObject, pose=Pose2D(12.0, 3.0, 0.5), **crate).success)
        objects.wait_for_after(0, lambda message: places_m(message) == [(12.0, 3.0)], "the crate")
        self.assertTrue(call("/simulation/set_object", SetObject, name="crate", pose=Pose2D(13.0, 3.5, 0.0)).success)
        objects.wait_for_after(0, lambda message: places_m(message) == [(13.0, 3.5)], "the crate elsewhere")
        drum = {"name": "drum", "kind": "barrel", "radius_m": 0.3, "mass_kg": 20.0}
        self.assertTrue(call("/simulation/set_object", SetObject, pose=Pose2D(14.0, 4.5, 0.0), **drum).success)
        self.assertTrue(call("/simulation/remove_object", RemoveObject, name="crate").success)
        left = objects.wait_for_after(0, lambda message: places_m(message) == [(14.0, 4.5)], "the drum alone")
        self.reset()
        self.assertFalse(call("/simulation/remove_object", RemoveObject, name="drum").success)
        self.assertEqual({marker.ns for marker in left.markers if marker.action == Marker.ADD}, {"objects"})

    def test_subscriber_that_comes_late_to_a_paused_world_gets_all_that_changes_rarely(self) -> None:
        self.assertTrue(call("/simulation/pause", Trigger).success)
        for name, kind in LATCHED.items():
            self.assertIsNotNone(rospy.wait_for_message(name, kind, TIMEOUT_S), name)
        self.assertTrue(call("/simulation/resume", Trigger).success)

    def test_subscriber_that_comes_late_to_a_paused_world_gets_objects_where_they_are(self) -> None:
        self.assertTrue(call("/simulation/pause", Trigger).success)
        crate = {"name": "crate", "kind": "box", "length_m": 0.6, "width_m": 0.4}
        self.assertTrue(call("/simulation/set_object", SetObject, pose=Pose2D(12.0, 3.0, 0.5), **crate).success)
        for place in ((12.0, 3.0), (13.0, 3.5)):
            self.assertTrue(call("/simulation/set_object", SetObject, name="crate", pose=Pose2D(*place, 0.0)).success)
            self.assertEqual(places_m(rospy.wait_for_message("/world/objects", MarkerArray, TIMEOUT_S)), [place])
        self.assertTrue(call("/simulation/remove_object", RemoveObject, name="crate").success)
        self.assertEqual(places_m(rospy.wait_for_message("/world/objects", MarkerArray, TIMEOUT_S)), [])
        self.assertTrue(call("/simulation/resume", Trigger).success)

    def test_invalid_object_is_rejected_with_the_reason(self) -> None:
        drum = {"name": "drum", "kind": "barrel", "radius_m": 0.3}
        self.assertTrue(call("/simulation/set_object", SetObject, pose=Pose2D(14.0, 4.5, 0.0), **drum).success)
        box = {"name": "box", "kind": "box", "length_m": 0.6, "width_m": 0.4}
        for fields, x_m, reason in (
            (box, 14.2, "box 'box': pose (14.20, 4.50) is inside barrel 'drum'"),
            (drum, 12.0, "there is already a barrel 'drum'"),
            ({"name": "box"}, 12.0, "unknown object 'box'; known: drum"),
            ({"name": "drum"}, math.nan, "barrel 'drum': pose must be finite"),
            ({**box, "kind": "bo"}, 12.0, "kind: 'bo' is not one of box, barrel"),
            ({**box, "width_m": 0.001}, 12.0, "length_m, width_m: 0.001 is not within 0.02 to 5"),
            ({**box, "mass_kg": -1.0}, 12.0, "mass_kg: -1.0 is below 1e-09"),
            ({**box, "friction": math.inf}, 12.0, "friction: "),
        ):
            refused = call("/simulation/set_object", SetObject, pose=Pose2D(x_m, 4.5, 0.0), **fields)
            self.assertFalse(refused.success)
            self.assertIn(reason, refused.message)
            self.assertNotIn("\n", refused.message)
        refused = call("/simulation/remove_object", RemoveObject, name="crate")
        self.assertEqual((refused.success, refused.message), (False, "unknown object 'crate'; known: drum"))

    def test_speed_is_obeyed_from_now_on(self) -> None:
        self.addCleanup(call, "/simulation/set_speed", SetSpeed, speed=SPEED)
        self.assertTrue(call("/simulation/set_speed", SetSpeed, speed=0.0).success)
        self.truths[0].wait_for_count(len(self.truths[0].messages) + 20)
        self.assertTrue(call("/simulation/set_speed", SetSpeed, speed=ENDLESS).success)
        before = latched_time()
        for _ in range(50):
            self.assertFalse(call("/simulation/set_speed", SetSpeed, speed=-1.0).success)
        # The tick under way and the one that time is counted from may still come.
        self.assertLessEqual((latched_time() - before).to_nsec(), 40_000_000)
        self.assertEqual(call("/simulation/reset", Trigger).message, "reset")
        self.assertTrue(call("/simulation/set_speed", SetSpeed, speed=0.0).success)
        self.truths[0].wait_for_count(len(self.truths[0].messages) + 20)

    def test_invalid_speed_is_rejected_with_the_reason(self) -> None:
        for speed in (-1.0, math.nan, math.inf):
            refused = call("/simulation/set_speed", SetSpeed, speed=speed)
            self.assertEqual(
                (refused.success, refused.message), (False, f"speed must be finite and >= 0, got {speed:g}")
            )

    def test_invalid_seed_is_rejected_with_the_reason(self) -> None:
        time = self.truths[0].next().header.stamp
        for seed, reason in ((-1, "seed: -1 is below 0"), (2**53 + 1, f"seed: {2**53 + 1} is above")):
            refused = call("/simulation/reset_seed", ResetSeed, seed=seed)
            self.assertFalse(refused.success)
            self.assertIn(reason, refused.message)
        self.assertGreater(self.truths[0].next().header.stamp, time)

    def test_seed_of_a_reset_is_that_of_later_resets(self) -> None:
        self.assertTrue(call("/simulation/reset_seed", ResetSeed, seed=2**40).success)
        self.reset()
        self.assertEqual(rospy.get_param("/robotteamsim/seed"), str(2**40))


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "controls", ControlsTest)
