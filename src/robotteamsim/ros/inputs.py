"""The topics that a node receives. Anybody can publish anything: what cannot be read is ignored, with one warning."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import rospy

from robotteamsim.geometry import PoseReading
from robotteamsim.message_parts import robot_name
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.robots import CONTACT, ODOM, SCAN, TRUTH, ContactReading
from robotteamsim.ros.messages import RosTypes
from robotteamsim.ros.settings import Settings
from robotteamsim.ros.topics import read, received_class
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.sensors import Sensor
from robotteamsim.scenario.sensors.base import Moment
from robotteamsim.sensing.readings import OdometryReading, RobotReading

LATEST_S = 2**32
"""A header has 32 bits for the seconds."""
QUEUED = 100
"""Largest number of messages of a publisher that wait to be read; older ones are dropped."""

_NO_CONTACT = ContactReading()
_NO_RANGES = np.zeros(0, dtype=np.float32)

logger = logging.getLogger(__name__)


def stamp_ns(message: Any) -> int:
    """Return the stamp of a message [ns], 0 without a header. Raises: ValueError: an answer could not have it."""
    if not hasattr(message, "header"):
        return 0
    stamp = message.header.stamp
    if stamp.secs + 1 >= LATEST_S:
        raise ValueError(f"stamp: {stamp.secs} s; expected below 2^32 s")
    return int(stamp.secs * 10**9 + stamp.nsecs)


def _always(_: int) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class Input:
    """A topic that a node receives.

    decode: returns the value of a message. Raises: ValueError.
    is_due: whether there is a message in the step with a stamp [ns].
    """

    topic: str
    message_class: type
    decode: Callable[[Any], Any]
    is_due: Callable[[int], bool] = _always

    @classmethod
    def of(cls, topic: Topic, settings: Settings, robot_id: int | None = None) -> Input:
        """Return a topic of the team, or of a robot."""
        assert topic.read is not None
        reader, setup, name = topic.read, settings.setup, topic.name
        if robot_id is not None:
            name = settings.robot_topic(robot_id, topic.name)
        message_class = RosTypes().message_class(topic.type_name)
        return cls(name, message_class, lambda message: reader(message, setup, robot_id))

    def listen(self, put: Callable[[str, int, Any], None], queue_size: int | None = None) -> None:
        """Subscribe. Args: put: called with topic, stamp [ns] and value, in a thread of the publisher."""
        is_warned = False

        def receive(raw: Any) -> None:
            nonlocal is_warned
            try:
                message = read(self.message_class, raw.data)
                stamp, value = stamp_ns(message), self.decode(message)
            except ValueError as error:
                if not is_warned:
                    is_warned = True
                    logger.warning("%s: ignoring messages that cannot be read: %s", self.topic, error)
            else:
                put(self.topic, stamp, value)

        rospy.Subscriber(
            self.topic, received_class(self.message_class), receive, queue_size=queue_size, tcp_nodelay=True
        )


class RobotInputs:
    """Makes `RobotReading` from the topics of one robot."""

    def __init__(self, settings: Settings, robot_id: int) -> None:
        robot, make, fire = settings.setup.robots[robot_id], RosTypes(), settings.scenario.fire
        self.odometry, self.truth, self.scan, self.contact = (
            Input.of(topic, settings, robot_id) for topic in (ODOM, TRUTH, SCAN, CONTACT)
        )
        self._sensors = {
            sensor.name: Input(
                f"/{robot_name(robot_id)}/{topic}",
                make.message_class(type_name),
                sensor.reading,
                partial(_is_due, sensor, settings.step_ns, fire),
            )
            for sensor in robot.sensors
            if fire is not None or not sensor.needs_fire
            for topic, type_name in list(sensor.topics.items())[:1]
        }
        self.additional = list(self._sensors.values())
        """The topics of `robots.sensors`."""

    def reading(self, values: Mapping[str, Any], pose: PoseReading | None = None) -> RobotReading:
        """Return the reading that consists of the values of topics.

        Args: pose: in `map`, from elsewhere than the ground truth.
        """
        odometry: OdometryReading = values[self.odometry.topic]
        # A real robot that navigates by odometry or tf has no ground truth.
        truth: OdometryReading = values.get(self.truth.topic, odometry)
        contact: ContactReading = values.get(self.contact.topic, _NO_CONTACT)
        return RobotReading(
            ground_truth=truth.pose if pose is None else pose,
            twist=truth.twist,
            odometry=odometry,
            ranges_m=values.get(self.scan.topic, _NO_RANGES),
            in_contact=contact.in_contact,
            contact_angles_rad=contact.angles_rad,
            sensors={name: values[one.topic] for name, one in self._sensors.items() if one.topic in values},
        )


def _is_due(sensor: Sensor, step_ns: int, fire: Fire | None, stamp: int) -> bool:
    fire_advances = fire is not None and fire.updates_at(stamp, step_ns=step_ns)
    return sensor.is_due(Moment(stamp, step_ns, fire_advances))
