"""The topics of the robots that the world publishes in each step."""

import math
from collections.abc import Sequence

import numpy as np
from tf2_msgs.msg import TFMessage

from robotteamsim import _ros_transport as roscpp
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.msg import TeamState
from robotteamsim.recording import ros_messages
from robotteamsim.recording.sensor_messages import SensorTopic, sensor_topics
from robotteamsim.ros.nodes.stage import UnprefixedTypes, robot_topic
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.serialization import serialized
from robotteamsim.ros.transport.team_poses import TEAM_STATE
from robotteamsim.ros.transport.topics import Output
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.readings import OdometryReading, RobotReading, TeamReadings

_ORIGIN = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())


class TeamOutputs:
    """The topics of all robots, and their tf.

    Messages are made once, by `recording.ros_messages`; in each step roscpp fills them from the readings' arrays.
    """

    def __init__(self, robots: Sequence[PlacedRobot], *, latched: bool, localized: bool, prefix: bool = True) -> None:
        """Args: localized: whether tf also has map -> odom, without error.

        prefix: whether topics and frames begin with robot_<id>/.
        """
        self._make = make = RosTypes() if prefix else UnprefixedTypes()
        ids = range(len(robots))
        still = RobotReading.of(_ORIGIN.pose, _ORIGIN.twist, _ORIGIN, np.zeros(0, np.float32), in_contact=False)
        truths = [serialized(ros_messages.ground_truth(make, 0, i, still)) for i in ids]
        odometry = [serialized(ros_messages.odometry(make, 0, i, _ORIGIN)) for i in ids]
        nothing_m = np.zeros(0, np.float32)
        scans = [serialized(ros_messages.scan(make, 0, i, robot.laser, nothing_m)) for i, robot in enumerate(robots)]
        contacts = [serialized(ros_messages.contact(make, 0, i, in_contact=False)) for i in ids]

        def names(topic: str) -> list[str]:
            return [robot_topic(robot_id, topic, prefix=prefix) for robot_id in ids]

        self._truth = roscpp.OdometryTopic(names("base_pose_ground_truth"), truths, latched=latched)
        self._odom = roscpp.OdometryTopic(names("odom"), odometry, latched=latched)
        self._scan = roscpp.ScanTopic(names("base_scan"), scans, latched=latched)
        self._contact = roscpp.ContactTopic(names("contact"), contacts, latched=latched)
        self._sensors: list[tuple[int, SensorTopic, Output]] = []
        for i, robot in enumerate(robots):
            for sensor in sensor_topics(robot):
                name = robot_topic(i, sensor.name, prefix=prefix)
                output = Output(name, make.message_class(sensor.type_name), latched=latched)
                self._sensors.append((i, sensor, output))
        self._team = Output(TEAM_STATE, TeamState, latched=latched)
        self._tf = _Tf(make, robots, localized)

    @property
    def num_subscribers(self) -> int:
        """Number of connections of the robots' topics."""
        of_sensors = sum(output.num_subscribers for _, _, output in self._sensors)
        topics = (self._truth, self._odom, self._scan, self._contact, self._team)
        return of_sensors + sum(topic.num_subscribers for topic in topics)

    def publish(self, time_ns: int, readings: TeamReadings, present: np.ndarray | None = None) -> None:
        """Publish one step's readings on topics with subscribers.

        Args: present: whether each robot is present, bool, shape (n,); None if all are. Others' topics are silent.
        """
        if self._truth.is_wanted:
            self._truth.publish(time_ns, readings.ground_truth, readings.twists, present=present)
        self._publish_odometry(time_ns, readings.odometry, present)
        if self._scan.is_wanted:
            self._scan.publish(time_ns, list(readings.ranges_m), present)
        if self._contact.is_wanted:
            self._contact.publish(time_ns, readings.in_contact, readings.contact_angles_rad, present)
        for robot_id, sensor, output in self._sensors:
            if present is not None and not present[robot_id]:
                continue
            further = readings[robot_id].further
            if output.wanted and (message := sensor.message(self._make, time_ns, robot_id, further)) is not None:
                output.publish(message)
        if self._team.wanted:
            self._team.publish(ros_messages.team_state(self._make, time_ns, readings))
        self._tf.publish(time_ns, readings, present)

    def publish_motion(self, time_ns: int, odometry: np.ndarray, present: np.ndarray | None = None) -> None:
        """Publish odometry and tf of a time between two steps. Args: odometry: as `TeamReadings.odometry`."""
        self._publish_odometry(time_ns, odometry, present)
        self._tf.publish_motion(time_ns, odometry, present)

    def _publish_odometry(self, time_ns: int, odometry: np.ndarray, present: np.ndarray | None) -> None:
        if not self._odom.is_wanted:
            return
        pose_covariances = ros_messages.pose_covariances(odometry[:, 7:13])
        twist_covariances = ros_messages.twist_covariances(odometry[:, 13:16])
        self._odom.publish(time_ns, odometry, odometry[:, 4:7], pose_covariances, twist_covariances, present)


class _Tf:
    """The frames of all robots, in one message."""

    def __init__(self, make: RosTypes, robots: Sequence[PlacedRobot], localized: bool) -> None:
        frames = [ros_messages.robot_transforms(make, 0, i, robot, _ORIGIN) for i, robot in enumerate(robots)]
        origins = [[ros_messages.localization(make, 0, i, _ORIGIN.pose)] for i in range(len(robots))]
        self._localized = localized
        self._origins: np.ndarray | None = None
        self._topic = roscpp.FramesTopic(
            "/tf",
            [serialized(TFMessage(transforms)) for transforms in frames],
            [serialized(TFMessage(transforms)) for transforms in origins] if localized else [],
        )

    def publish(self, time_ns: int, readings: TeamReadings, present: np.ndarray | None) -> None:
        """Publish one step's frames, if there is a subscriber."""
        if self._localized:
            places = [_origin(reading) for reading in readings]
            self._origins = np.array([(place.x_m, place.y_m, place.qz, place.qw) for place in places])
        self.publish_motion(time_ns, readings.odometry, present)

    def publish_motion(self, time_ns: int, odometry: np.ndarray, present: np.ndarray | None) -> None:
        """Publish the frames of a time between two steps: map -> odom is that of the last step."""
        if self._topic.is_wanted:
            self._topic.publish(time_ns, odometry, self._origins, present)


def _origin(reading: RobotReading) -> PoseReading:
    """Return the origin of a robot's odometry in `map`."""
    if math.isnan(reading.ground_truth.x_m):
        return _ORIGIN.pose  # of a robot that is not present; it is not published
    return PoseReading.from_pose(reading.ground_truth.pose @ reading.odometry.pose.pose.inverse())
