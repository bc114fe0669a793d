"""A recorded mission in Gazebo: the messages of its bag, by topic and stamp."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Reader

from robotteamsim.geometry import PoseReading
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

ROBOT_TOPICS = ("odom", "base_scan", "base_pose_ground_truth", "contact")
_TURN_RAD = 0.001
"""Beams may pass a corner on either side if they differ by less than this."""


class Recording:
    """The robots' messages of a bag."""

    def __init__(self, path: Path, num_robots: int) -> None:
        typestore = bag_typestore()
        topics = [f"/robot_{i}/{name}" for i in range(num_robots) for name in ROBOT_TOPICS]
        self.by_stamp: dict[str, dict[int, Any]] = {topic: {} for topic in topics}
        with Reader(path) as bag:
            connections = [connection for connection in bag.connections if connection.topic in topics]
            for connection, _, data in bag.messages(connections):
                message = typestore.deserialize_ros1(data, connection.msgtype)
                stamp = message.header.stamp
                self.by_stamp[connection.topic][stamp.sec * 10**9 + stamp.nanosec] = message

    def of(self, robot_id: int, name: str) -> dict[int, Any]:
        """Return the messages of a robot's topic by stamp [ns]."""
        return self.by_stamp[f"/robot_{robot_id}/{name}"]

    def track_m(self, robot_id: int) -> np.ndarray:
        """Return the true positions of a robot, shape (n, 2) [m]."""
        poses = [message.pose.pose.position for message in self.of(robot_id, "base_pose_ground_truth").values()]
        return np.array([(position.x, position.y) for position in poses])

    def pose(self, robot_id: int, stamp_ns: int) -> tuple[float, float, float]:
        """Return the true pose of a robot [m, m, rad]."""
        pose = self.of(robot_id, "base_pose_ground_truth")[stamp_ns].pose.pose
        reading = PoseReading(pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w)
        return reading.pose.x_m, reading.pose.y_m, reading.pose.yaw_rad


def scans_m(scenario: Scenario, robots: tuple[PlacedRobot, ...], poses: list[tuple[float, float, float]]) -> Any:
    """Return what our own lasers measure with the robots at some poses.

    Returns: shortest, exact and longest ranges [m], shape (3, robots, beams): the first and the last are those of
             all beams that differ in their direction by up to a milliradian.
    """
    found = []
    for turn_rad in (0.0, _TURN_RAD, -_TURN_RAD):
        placed = tuple(
            robot.model_copy(update={"start_pose": (x, y, yaw + turn_rad)})
            for robot, (x, y, yaw) in zip(robots, poses, strict=True)
        )
        world = World(scenario.plan, placed, scenario.run)
        found.append(np.array(RobotSensors(world, placed, seed=1).read().ranges_m))
    return np.array([np.min(found, axis=0), found[0], np.max(found, axis=0)])
