"""The poses of one robot for the 3D scene: the ground truth, or tf where there is none."""

from __future__ import annotations

from typing import Protocol

from nav_msgs.msg import Odometry

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.feed import GROUND_TRUTH, Feed
from robotteamsim.ros.transport import msg_conversion
from robotteamsim.ros.transport.tf_pose import TfPose, Transforms


class PoseFeed(Protocol):
    """The poses of a robot since they were last taken."""

    def take(self, at_most: int) -> list[tuple[int, Pose]]:
        """Return stamps [ns] and poses in `map`, oldest first: at most `at_most`, with the newest."""

    def close(self) -> None:
        """Unsubscribe."""


class TruePoses:
    """The ground truth."""

    def __init__(self, prefix: str) -> None:
        self._feed = Feed(prefix + GROUND_TRUTH, Odometry, keep=1000)

    def take(self, at_most: int) -> list[tuple[int, Pose]]:
        """As for all feeds."""
        truths = self._feed.take(at_most)
        return [(msg_conversion.stamp_ns(truth), msg_conversion.odometry_reading(truth).pose.pose) for truth in truths]

    def close(self) -> None:
        """Unsubscribe."""
        self._feed.close()


class TfPoses:
    """The newest transform of a robot, with the stamp of its newest odometry."""

    def __init__(self, prefix: str, transforms: Transforms, tf: TfPose) -> None:
        self._feed = Feed(f"{prefix}odom", Odometry)
        self._transforms, self._tf = transforms, tf
        self._stamp_ns = -1

    def take(self, at_most: int) -> list[tuple[int, Pose]]:
        """As for all feeds; poses between two calls are left out."""
        odometry = self._feed.newest()
        if odometry is None:
            return []
        stamp_ns = msg_conversion.stamp_ns(odometry)
        if stamp_ns < self._stamp_ns:
            self._transforms.clear()
            self._tf.restart()
        self._stamp_ns = stamp_ns
        self._tf.follow(stamp_ns)
        return [] if self._tf.newest is None else [(stamp_ns, self._tf.newest.pose)]

    def close(self) -> None:
        """Unsubscribe."""
        self._feed.close()
