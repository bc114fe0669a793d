"""What all robots sense, as bytes made of the team's arrays: messages of genpy would take several times as long."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from robotteamsim.nodes.motion import TeamOdometry
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.outputs import ORIGIN, Motion, StepInputs, TeamOutputs
from robotteamsim.nodes.settings import Settings
from robotteamsim.recording.topics import Topic, robots
from robotteamsim.recording.topics.robots import ODOM, SCAN, TRUTH
from robotteamsim.ros.topics import serialized
from robotteamsim.sensing.readings import RobotReading, state_of

_HEADER_BYTES = 12
"""Of number and stamp, with which a message with a header begins."""
_POSE = np.dtype([("position", "<f8", 3), ("orientation", "<f8", 4)])
"""The numbers of geometry_msgs/Pose, in the order in which they are sent."""
_ODOMETRY = np.dtype(
    [
        ("pose", _POSE),
        ("pose_covariance", "<f8", 36),
        ("linear", "<f8", 3),
        ("angular", "<f8", 3),
        ("twist_covariance", "<f8", 36),
    ]
)
"""Those of nav_msgs/Odometry."""
_BULK = {TRUTH: _ODOMETRY.itemsize, ODOM: _ODOMETRY.itemsize, SCAN: 8}
"""Topics whose messages are made in bulk, and the bytes of their numbers: pose, twist and covariances; two counts."""


class BulkTeamOutputs(TeamOutputs):
    """As `TeamOutputs`. Everything but stamps and numbers is taken from messages that are made once."""

    def __init__(self, node: Node, settings: Settings, *, localized: bool) -> None:
        """As for all outputs of a team."""
        super().__init__(node, settings, localized=localized)
        models = self._models
        still = RobotReading(ORIGIN.pose, ORIGIN.twist, ORIGIN, np.zeros(0, np.float32), in_contact=False)
        team = [still] * len(models)
        begin = Motion(0, np.zeros(len(models), bool), team, state_of(team))
        self._heads = {
            topic: {i: _tail(self._messages(topic, begin, i)[0], size) for i in self._here}
            for topic, size in _BULK.items()
        }
        self._frames = {
            i: [_tail(frame) for frame in robots.robot_transforms(self._make, 0, i, models[i], ORIGIN)]
            for i in self._here
        }
        self._numbers: dict[Topic, Any] = {}
        """What follows each head, by topic and robot."""

    def publish(self, step: Any, only: Topic | None = None) -> None:
        """As for all outputs of a team."""
        state = step.state
        self._numbers = {TRUTH: _odometry_rows(state.true_pose, state.true_twist)}
        self._numbers[SCAN] = [state.ranges_of(robot_id) for robot_id in range(len(state))]
        self._numbers[ODOM] = _odometry_rows_of(TeamOdometry.of(state))
        super().publish(step, only)

    def publish_motion(self, time_ns: int, odometry: TeamOdometry, present: np.ndarray) -> None:
        """As for all outputs of a team."""
        self._numbers[ODOM] = _odometry_rows_of(odometry)
        super().publish_motion(time_ns, odometry, present)

    def _publish(self, output: Any, topic: Topic, step: StepInputs, robot_id: int) -> None:
        if topic not in self._heads:
            super()._publish(output, topic, step, robot_id)
            return
        numbers = self._numbers[topic][robot_id].tobytes()
        if topic is SCAN:  # their number before the ranges, and no intensities after them
            numbers = struct.pack("<I", len(numbers) // 4) + numbers + bytes(4)
        output.publish_bytes(_begin(step.sim_time_ns) + self._heads[topic][robot_id] + numbers)

    def _publish_tf(self, time_ns: int, odometry: TeamOdometry, present: np.ndarray) -> None:
        tf: Any = self._tf
        if not tf.wanted:
            return
        head, parts, count = _begin(time_ns), [], 0
        poses = _plane_poses(odometry.pose)
        here = [robot_id for robot_id in self._here if present[robot_id]]
        for i in here:
            first, *others = self._frames[i]
            # The first one, odom -> base_footprint, ends with the pose.
            parts += [head, first[: -_POSE.itemsize], poses[i].tobytes()]
            for frame in others:
                parts += [head, frame]
            count += len(self._frames[i])
        if self._localized:
            parts += [serialized(robots.localization(self._make, time_ns, i, self._origins[i])) for i in here]
            count += len(here)
        tf.publish_bytes(b"".join((struct.pack("<I", count), *parts)))


def _tail(message: Any, numbers: int = 0) -> bytes:
    """Return a message without number and stamp, and without so many bytes at its end."""
    data = serialized(message)
    return data[_HEADER_BYTES : len(data) - numbers]


def _begin(time_ns: int) -> bytes:
    """Return the number, which roscpp counts, and the stamp of a header."""
    return struct.pack("<III", 0, *divmod(time_ns, 10**9))


def _plane_poses(poses: np.ndarray) -> np.ndarray:
    """Return x, y, qz, qw as the numbers of geometry_msgs/Pose, shape (n,)."""
    rows = np.zeros(len(poses), _POSE)
    rows["position"][:, :2], rows["orientation"][:, 2:] = poses[:, :2], poses[:, 2:]
    return rows


def _odometry_rows(poses: np.ndarray, twists: np.ndarray) -> np.ndarray:
    """Return the numbers of nav_msgs/Odometry, shape (n,)."""
    rows = np.zeros(len(poses), _ODOMETRY)
    rows["pose"] = _plane_poses(poses)
    rows["linear"][:, :2], rows["angular"][:, 2] = twists[:, :2], twists[:, 2]
    return rows


def _odometry_rows_of(odometry: TeamOdometry) -> np.ndarray:
    rows = _odometry_rows(odometry.pose, odometry.twist)
    rows["pose_covariance"] = robots.pose_covariances(odometry.pose_covariance)
    rows["twist_covariance"] = robots.twist_covariances(odometry.twist_variances)
    return rows
