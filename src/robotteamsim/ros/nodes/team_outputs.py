"""What the world publishes of its robots in each step."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.msg import Contact
from robotteamsim.recording import ros_messages
from robotteamsim.recording.sensor_messages import SensorTopic, sensor_topics
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.node import Output
from robotteamsim.ros.transport.packed_messages import PackedRows, serialized
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.readings import OdometryReading, RobotReading, TeamReadings

_NOWHERE = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())


class TeamOutputs:
    """The topics of all robots, and their tf.

    Messages are made once, by `recording.ros_messages`, and in each step filled with what has changed. The header's
    `seq` counts the steps that were published.
    """

    def __init__(self, robots: Sequence[PlacedRobot], *, latched: bool, localized: bool) -> None:
        """Args: localized: tf has map -> odom, too, free of error."""
        self._make = make = RosTypes()
        self._seq = 0

        def topic(name: str, message_class: type, example: Callable[[int], Any]) -> _RobotTopic:
            return _RobotTopic(name, message_class, [example(robot_id) for robot_id in range(len(robots))], latched)

        def example_scan(robot_id: int) -> Any:
            laser = robots[robot_id].laser
            return ros_messages.scan(make, 0, robot_id, laser, np.zeros(laser.beams, np.float32))

        still = RobotReading(_NOWHERE.pose, _NOWHERE.twist, _NOWHERE, np.zeros(0, np.float32), in_contact=False)
        self._truth = topic("base_pose_ground_truth", Odometry, lambda i: ros_messages.ground_truth(make, 0, i, still))
        self._odom = topic("odom", Odometry, lambda i: ros_messages.odometry(make, 0, i, _NOWHERE))
        self._scan = topic("base_scan", LaserScan, example_scan)
        self._contact = topic("contact", Contact, lambda i: ros_messages.contact(make, 0, i, in_contact=False))
        self._topics = (self._truth, self._odom, self._scan, self._contact)
        self._sensors: list[tuple[int, SensorTopic, Output]] = []
        for i, robot in enumerate(robots):
            for sensor in sensor_topics(robot):
                name = f"/{ros_messages.robot_name(i)}/{sensor.name}"
                output = Output(name, make.message_class(sensor.type_name), latched=latched)
                self._sensors.append((i, sensor, output))
        self._tf = _Tf(make, robots, localized)

    @property
    def num_subscribers(self) -> int:
        """How many connections the robots' topics have."""
        of_sensors = sum(output.num_subscribers for _, _, output in self._sensors)
        return of_sensors + sum(topic.num_subscribers for topic in self._topics)

    def publish(self, time_ns: int, readings: TeamReadings, present: np.ndarray | None = None) -> None:
        """Publish one step's readings, where somebody gets them.

        Args: present: whether each robot is there, bool, shape (n,); None: all are. The topics of others are silent.
        """
        self._seq += 1
        if self._truth.wanted:
            _set_pose(self._truth.messages, "0.pose.pose.position", "0.pose.pose.orientation", readings.ground_truth)
            _set_twist(self._truth.messages, readings.twists)
        if self._odom.wanted:
            odometry, messages = readings.odometry, self._odom.messages
            _set_pose(messages, "0.pose.pose.position", "0.pose.pose.orientation", odometry)
            _set_twist(messages, odometry[:, 4:7])
            messages.set("0.pose.covariance", ros_messages.pose_covariances(odometry[:, 7:13]))
            messages.set("0.twist.covariance", ros_messages.twist_covariances(odometry[:, 13:16]))
        if self._scan.wanted:
            self._scan.messages.set("0.ranges.data", readings.ranges_m)
        if self._contact.wanted:
            self._contact.instead = self._touching(time_ns, readings)
        for topic in self._topics:
            topic.publish(time_ns, self._seq, present)
        for robot_id, sensor, output in self._sensors:
            if present is not None and not present[robot_id]:
                continue
            further = readings[robot_id].further
            if output.wanted and (message := sensor.message(self._make, time_ns, robot_id, further)) is not None:
                output.publish(message)
        self._tf.publish(time_ns, readings, present)

    def _touching(self, time_ns: int, readings: TeamReadings) -> dict[int, memoryview]:
        """Return the messages of robots that touch something, by their ids; they differ in length."""
        messages = {}
        for robot_id in np.flatnonzero(readings.in_contact).tolist():
            angles_rad = readings.contact_angles_rad.get(robot_id, ())
            message = ros_messages.contact(self._make, time_ns, robot_id, True, angles_rad)
            message.header.seq = self._seq
            messages[robot_id] = memoryview(serialized([message], with_length=True))
        return messages


class _RobotTopic:
    """One topic of each robot."""

    def __init__(self, name: str, message_class: type, examples: Sequence[Any], latched: bool) -> None:
        self.messages = PackedRows([[example] for example in examples], with_length=True)
        self.instead: Mapping[int, memoryview] = {}
        """What some robots, by their ids, send in this step instead of their row."""
        self._outputs = [
            Output(f"/{ros_messages.robot_name(robot_id)}/{name}", message_class, latched=latched)
            for robot_id in range(len(examples))
        ]

    @property
    def wanted(self) -> bool:
        """Whether somebody gets the next messages, of whichever robot."""
        return any(output.wanted for output in self._outputs)

    @property
    def num_subscribers(self) -> int:
        """How many connections all of them have."""
        return sum(output.num_subscribers for output in self._outputs)

    def publish(self, time_ns: int, seq: int, present: np.ndarray | None) -> None:
        """Publish the messages as they are now, of robots that are there (None: all)."""
        self.messages.stamp(time_ns, seq)
        for robot_id, (output, row) in enumerate(zip(self._outputs, self.messages.rows, strict=True)):
            if present is not None and not present[robot_id]:
                continue
            output.publish_bytes(self.instead.get(robot_id, row))


class _Tf:
    """The frames of all robots, in one message."""

    def __init__(self, make: RosTypes, robots: Sequence[PlacedRobot], localized: bool) -> None:
        self._output = Output("/tf", TFMessage)
        self._robots = PackedRows(
            [
                ros_messages.robot_transforms(make, 0, robot_id, robot, _NOWHERE)
                for robot_id, robot in enumerate(robots)
            ],
            with_length=False,
        )
        self._localization = (
            PackedRows(
                [[ros_messages.localization(make, 0, i, _NOWHERE.pose)] for i in range(len(robots))], with_length=False
            )
            if localized
            else None
        )

    def publish(self, time_ns: int, readings: TeamReadings, present: np.ndarray | None) -> None:
        """Publish one step's frames, if anybody listens."""
        if not self._output.wanted:
            return
        _set_pose(self._robots, "0.transform.translation", "0.transform.rotation", readings.odometry)
        self._robots.stamp(time_ns, 0)
        count, data = self._robots.chosen(present)
        if self._localization is not None:
            origins = [_origin(reading) for reading in readings]
            places = np.array([(place.x_m, place.y_m, place.qz, place.qw) for place in origins])
            _set_pose(self._localization, "0.transform.translation", "0.transform.rotation", places)
            self._localization.stamp(time_ns, 0)
            more, more_data = self._localization.chosen(present)
            count, data = count + more, data + more_data
        lengths = (4 + len(data)).to_bytes(4, "little") + count.to_bytes(4, "little")
        self._output.publish_bytes(memoryview(lengths + data))


def _origin(reading: RobotReading) -> PoseReading:
    """Return where a robot's odometry has its origin in `map`."""
    if math.isnan(reading.ground_truth.x_m):
        return _NOWHERE.pose  # of a robot that is not there; nobody is told
    return PoseReading.from_pose(reading.ground_truth.pose @ reading.odometry.pose.pose.inverse())


def _set_pose(rows: PackedRows, position: str, orientation: str, poses: np.ndarray) -> None:
    """Args: poses: x, y, qz, qw in the first four columns."""
    for column, path in enumerate((f"{position}.x", f"{position}.y", f"{orientation}.z", f"{orientation}.w")):
        rows.set(path, poses[:, column])


def _set_twist(messages: PackedRows, twists: np.ndarray) -> None:
    """Args: twists: forward, left, counter-clockwise."""
    for column, path in enumerate(("linear.x", "linear.y", "angular.z")):
        messages.set(f"0.twist.twist.{path}", twists[:, column])
