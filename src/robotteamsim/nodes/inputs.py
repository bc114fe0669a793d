"""The topics that a node receives. Anybody can publish anything: what cannot be read is ignored, with one warning."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from robotteamsim.errors import SensorError
from robotteamsim.geometry import PoseReading
from robotteamsim.message_parts import robot_name
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.settings import Settings
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.robots import BODY_TOPICS, CONTACT, ODOM, SCAN, TRUTH, ContactReading
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.sensors import Sensor
from robotteamsim.scenario.sensors.base import Moment, reading_of
from robotteamsim.sensing.readings import OdometryReading, RobotReading

QUEUED = 100
"""Largest number of messages of a publisher that wait to be read; older ones are dropped."""

_NO_CONTACT = ContactReading()
_NO_RANGES = np.zeros(0, dtype=np.float32)

logger = logging.getLogger(__name__)


def _always(_: int) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class Input:
    """A topic that a node receives.

    decode:  returns the value of a message. Raises: ValueError.
    is_due:  whether there is a message in the step with a stamp [ns].
    latched: whether the publisher keeps the last message.
    lossy:   whether the publisher may lose some.
    """

    node: Node
    topic: str
    type_name: str
    decode: Callable[[Any], Any]
    is_due: Callable[[int], bool] = _always
    latched: bool = False
    lossy: bool = False

    @classmethod
    def of(cls, node: Node, topic: Topic, settings: Settings, robot_id: int | None = None) -> Input:
        """Return a topic of the team, or of a robot."""
        assert topic.read is not None
        reader, setup, name = topic.read, settings.setup, topic.name
        if robot_id is not None:
            name = settings.robot_topic(robot_id, topic.name)
        latched, lossy = settings.is_latched(topic), robot_id in settings.elsewhere and topic in BODY_TOPICS
        found = cls(node, name, topic.type_name, lambda message: reader(message, setup, robot_id))
        return replace(found, latched=latched, lossy=lossy)

    def listen(self, put: Callable[[str, int, Any], None], queue_size: int | None = None) -> None:
        """Subscribe. Args: put: called with topic, stamp [ns] and value, in another thread."""
        is_warned = False

        def receive(data: bytes) -> None:
            nonlocal is_warned
            try:
                stamp_ns, message = self.node.read(self.type_name, data)
                value = self.decode(message)
            except (ValueError, SensorError) as error:
                if not is_warned:
                    is_warned = True
                    logger.warning("%s: ignoring messages that cannot be read: %s", self.topic, error)
            else:
                put(self.topic, stamp_ns, value)

        quality = {"latched": self.latched, "lossy": self.lossy}
        self.node.listen(self.topic, self.type_name, receive, **quality, queue_size=queue_size)


class RobotInputs:
    """Makes `RobotReading` from the topics of one robot."""

    def __init__(self, node: Node, settings: Settings, robot_id: int) -> None:
        robot, fire = settings.setup.robots[robot_id], settings.scenario.fire
        self.odometry, self.truth, self.scan, self.contact = (
            Input.of(node, topic, settings, robot_id) for topic in (ODOM, TRUTH, SCAN, CONTACT)
        )
        self._sensors = {
            sensor.name: Input(
                node,
                f"/{robot_name(robot_id)}/{topic}",
                type_name,
                partial(reading_of, sensor, robot_id),
                partial(_is_due, sensor, settings.step_ns, fire),
                latched=settings.lockstep,
                lossy=robot_id in settings.elsewhere,
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
