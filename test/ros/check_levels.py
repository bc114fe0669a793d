#!/usr/bin/env python3
"""Compares a lockstep mission on two levels with the same mission without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions report the values

from __future__ import annotations

import rospy
import rostest
from compared import ComparedMission, Log
from listening import Topic, call
from nav_msgs.msg import OccupancyGrid
from robotteamsim.srv import TakePassage
from tf2_msgs.msg import TFMessage


class LevelsTest(ComparedMission):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.frames = Topic("/tf_static", TFMessage)
        cls.maps = [Topic(f"/{name}/map", OccupancyGrid) for name in ("L1", "L2")]
        cls.expected = Log(rospy.get_param("/robotteamsim/scenario"), cls.settings)
        cls.first = cls.document_at_end()

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        self.assert_as_expected(self.first, self.expected)
        changes = {(event["robot_id"], event["detail"]) for event in self.first["events"]}
        self.assertLessEqual({(0, "robot 0 is on level L2"), (1, "robot 1 is on level L2")}, changes)

    def test_frames_of_levels_are_at_their_origins(self) -> None:
        (message,) = self.frames.wait_for_count(1)
        places = [(link.child_frame_id, link.transform.translation) for link in message.transforms]
        self.assertEqual({link.header.frame_id for link in message.transforms}, {"map"})
        self.assertEqual(
            [(name, at.x, at.y, at.z) for name, at in places], [("L1", 1.0, 1.0, 0.0), ("L2", 16.0, 1.0, 0.0)]
        )

    def test_maps_of_levels_begin_at_the_same_place_of_the_building(self) -> None:
        for topic in self.maps:
            (grid,) = topic.wait_for_count(1)
            self.assertEqual(grid.header.frame_id, topic.name.split("/")[1])
            self.assertEqual((grid.info.origin.position.x, grid.info.origin.position.y), (-1.0, -1.0))
            self.assertEqual((grid.info.width, grid.info.height), (240, 200))

    def test_y_service_takes_a_robot_only_to_another_level_that_exists(self) -> None:
        refused = call("/simulation/take_passage", TakePassage, robot_id=0, level="L3")
        self.assertEqual(
            (refused.success, refused.message),
            (False, "take_passage: there is no passage to level 'L3'; expected L1 or L2"),
        )
        self.assertTrue(call("/simulation/take_passage", TakePassage, robot_id=0, level="L1").success)

    def test_z_reset_repeats_the_mission(self) -> None:
        self.assert_as_expected(self.document_after("/simulation/reset"), self.expected)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "levels", LevelsTest)
