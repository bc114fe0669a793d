"""Robots of another world, which stand still: what their drivers publish, and a node that locates them."""

from __future__ import annotations

import threading

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from peer import ALL_LATCHED, Peer
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from robotteamsim.setup import Setup

PERIOD_S, STEP_NS = 0.02, 100_000_000


class Outside:
    """Publishes a step of 0.1 s of all robots every 0.02 s, by best effort as drivers do."""

    def __init__(self, peer: Peer, setup: Setup, *, has_truth: bool) -> None:
        """Args: has_truth: whether robots publish their true poses; otherwise tf has them, while they are located."""
        node, self._robots, self._has_truth = peer.node, setup.robots, has_truth
        self.located = set(range(len(setup.robots)))
        self._outputs = [
            {
                name: node.create_publisher(kind, f"/robot_{i}/{name}", qos_profile_sensor_data)
                for name, kind in (("odom", Odometry), ("base_scan", LaserScan), ("base_pose_ground_truth", Odometry))
                if has_truth or name != "base_pose_ground_truth"
            }
            for i in range(len(setup.robots))
        ]
        self._tf = node.create_publisher(TFMessage, "/tf", 100)
        self._static = node.create_publisher(TFMessage, "/tf_static", ALL_LATCHED)
        self._static.publish(
            TFMessage(transforms=[self._link(0, i, "base_footprint", "base_link") for i in self.located])
        )
        self._step = 0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> Outside:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ended.wait(PERIOD_S):
            self._step += 1
            for i, robot in enumerate(self._robots):
                self._publish(i, robot, self._step * STEP_NS)

    def _publish(self, robot_id, robot, time_ns):
        laser, outputs = robot.laser, self._outputs[robot_id]
        scan = LaserScan(ranges=[laser.range_max_m] * laser.beams)
        odometry, truth = Odometry(), Odometry()
        truth.pose.pose.position.x, truth.pose.pose.position.y, _ = map(float, robot.start_pose)
        for message in (scan, odometry, truth):
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(time_ns, 10**9)
        links = [self._link(time_ns, robot_id, "odom", "base_footprint")]
        if robot_id in self.located:
            links.append(self._link(time_ns, robot_id, None, "odom", robot.start_pose))
        if not self._has_truth:
            self._tf.publish(TFMessage(transforms=links))
        for name, message in (("odom", odometry), ("base_scan", scan), ("base_pose_ground_truth", truth)):
            if name in outputs:
                outputs[name].publish(message)

    def _link(self, time_ns, robot_id, parent, child, pose=(0.0, 0.0, 0.0)):
        link = TransformStamped(child_frame_id=f"robot_{robot_id}/{child}")
        link.header.frame_id = "map" if parent is None else f"robot_{robot_id}/{parent}"
        link.header.stamp.sec, link.header.stamp.nanosec = divmod(time_ns, 10**9)
        link.transform.translation.x, link.transform.translation.y, _ = map(float, pose)
        return link
