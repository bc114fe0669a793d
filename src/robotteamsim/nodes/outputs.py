"""The topics that nodes publish: rows of `recording.topics`."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.message_parts import RosMessage
from robotteamsim.mission import Sensed
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.status import MissionStatus
from robotteamsim.nodes.motion import TeamOdometry
from robotteamsim.nodes.node import Node, Output
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.stage import unprefixed
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics import RECORD_TOPICS, Changes, Source, Topic, When, robots
from robotteamsim.recording.topics.beliefs import BELIEF_TOPICS, ORIGIN
from robotteamsim.recording.topics.decisions import COMMAND, DECISION_TOPICS
from robotteamsim.recording.topics.mission import MISSION_TOPICS
from robotteamsim.recording.topics.radio import RADIO_MAP_TOPICS, VOICE_MAP_TOPICS
from robotteamsim.recording.topics.robots import BODY_TOPICS, ODOM, TF
from robotteamsim.recording.topics.world import DOORS, OBJECTS, ROBOTS, WORLD_TOPICS
from robotteamsim.scenario.sensors.base import messages_of, naming
from robotteamsim.sensing.readings import OdometryReading, RobotReading
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.world.contract import AnyWorld, ObjectStates

RADIO_MAP_PERIOD_NS = 10**9

AT_ORIGIN = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())
"""Of a robot at the origin of its odometry."""


class Decided(NamedTuple):
    """The part of a step that controllers publish: of the robots by their ids.

    readings: of robots that have decided, in the step that they answer.
    """

    sim_time_ns: int
    present: Mapping[int, bool] | np.ndarray
    decisions: Mapping[int, Decision] | Sequence[Decision]
    readings: Mapping[int, RobotReading] | Sequence[RobotReading]


class _Moved(NamedTuple):
    """The part of a robot's readings that changes between two steps."""

    odometry: OdometryReading


class Motion(NamedTuple):
    """What robots sense between two steps."""

    sim_time_ns: int
    present: np.ndarray
    readings: Sequence[_Moved]


StepInputs = Sensed | Decided | Motion


def output_of(node: Node, topic: Topic, settings: Settings, robot_id: int | None = None) -> Output:
    """Advertise a topic of the team or of a robot."""
    name = topic.name if robot_id is None else settings.robot_topic(robot_id, topic.name)
    return node.output(name, topic.type_name, latched=settings.is_latched(topic))


class RobotOutputs:
    """Topics of several robots."""

    def __init__(self, node: Node, topics: Iterable[tuple[int, Topic]], settings: Settings) -> None:
        """Advertise topics of robots, by their ids."""
        self._node = node
        self._has_prefix = settings.prefix
        self._source = Source(settings.setup)
        self._outputs = [
            (topic, i, output_of(node, topic, settings, None if topic is ORIGIN else i)) for i, topic in topics
        ]

    def publish(self, step: StepInputs, only: Topic | None = None) -> None:
        """Publish the messages of the present robots that somebody receives. Args: only: one of the topics."""
        for topic, robot_id, output in self._outputs:
            if step.present[robot_id] and output.wanted and only in (None, topic):
                for message in topic.messages(step.sim_time_ns, topic.values(self._source, step, robot_id)):
                    output.publish(self._named(message, robot_id))

    def _named(self, message: RosMessage, robot_id: int) -> RosMessage:
        """Return a message with the names that frames have here."""
        return message if self._has_prefix else unprefixed(message, robot_id)


def decision_outputs(node: Node, settings: Settings, robot_ids: Iterable[int]) -> RobotOutputs:
    """Advertise what the controllers of robots publish: `cmd_vel` only for robots that are not driven by hand."""
    topics = [one for one in (*DECISION_TOPICS, *BELIEF_TOPICS, ORIGIN) if one.is_in(settings.scenario)]
    rest = [topic for topic in topics if topic is not COMMAND]
    rows = [(i, topic) for i in robot_ids for topic in (rest if settings.is_driven_by_hand(i) else topics)]
    return RobotOutputs(node, rows, settings)


class TeamOutputs(RobotOutputs):
    """What all robots sense, and their tf."""

    def __init__(self, node: Node, settings: Settings, *, localized: bool) -> None:
        """Args: localized: as in `Source`."""
        self._models = models = settings.setup.robots
        self._here = [robot_id for robot_id in range(len(models)) if robot_id not in settings.elsewhere]
        super().__init__(node, itertools.product(self._here, BODY_TOPICS), settings)
        self._sensors = [
            (i, sensor, {name: self._sensor_output(settings, i, name, kind) for name, kind in sensor.topics.items()})
            for i in self._here
            for sensor in models[i].sensors
        ]
        self._tf = output_of(node, TF, settings)
        # The controllers of robots that localise themselves publish what these believe.
        self._localized = localized and not settings.scenario.control.localises
        self._origins: Sequence[PoseReading] = ()

    def _sensor_output(self, settings: Settings, robot_id: int, name: str, type_name: str) -> Output:
        return self._node.output(settings.robot_topic(robot_id, name), type_name, latched=settings.lockstep)

    def publish(self, step: Any, only: Topic | None = None) -> None:
        """Publish one step's readings of the present robots on topics with subscribers."""
        state = step.state
        super().publish(step, only)
        for i, sensor, outputs in self._sensors:
            measured = state.sensors.get(i, {})
            if sensor.name in measured and any(output.wanted for output in outputs.values()):
                reading, step_s = measured[sensor.name], self._source.setup.scenario.run.step_s
                messages = messages_of(sensor, step.sim_time_ns, i, reading, step_s)
                with naming(sensor, i):
                    for name, message in messages.items():
                        outputs[name].publish(self._named(message, i))
        if self._localized:
            self._origins = [robots.odometry_origin(one.true_pose, one.odometry) for one in step.readings]
        self._publish_tf(step)

    def publish_motion(self, time_ns: int, odometry: TeamOdometry, present: np.ndarray) -> None:
        """Publish odometry and tf of a time between two steps."""
        motion = Motion(time_ns, present, [_Moved(reading) for reading in odometry.readings()])
        super().publish(motion, only=ODOM)
        self._publish_tf(motion)

    def _publish_tf(self, step: Any) -> None:
        """Args: step: a `Motion`, or a record with what it has."""
        if self._tf.wanted:
            here = [robot_id for robot_id in self._here if step.present[robot_id]]
            self._tf.publish({"transforms": [link for robot_id in here for link in self._links(step, robot_id)]})

    def _links(self, step: Any, robot_id: int) -> list[RosMessage]:
        """Return the transforms of a robot."""
        time_ns, odometry = step.sim_time_ns, step.readings[robot_id].odometry
        links = robots.robot_transforms(time_ns, robot_id, self._models[robot_id], odometry)
        origin = [robots.localization(time_ns, robot_id, self._origins[robot_id])] if self._localized else []
        return [self._named(link, robot_id) for link in (*origin, *links)]


class RadioMapOutputs:
    """The signal of each robot over the floor, once a second for subscribers."""

    def __init__(self, node: Node, settings: Settings, robot_ids: Iterable[int]) -> None:
        """Advertise."""
        self._source = Source(settings.setup)
        rows = itertools.product(robot_ids, RADIO_MAP_TOPICS)
        self._outputs = {(i, topic): output_of(node, topic, settings, i) for i, topic in rows}
        self.restart()

    def restart(self) -> None:
        """Restart with the first step."""
        self._due_ns = dict.fromkeys(self._outputs, 0)

    def publish(self, record: StepRecord, radio_map: Callable[[int], FieldMap]) -> None:
        """Publish the maps of present robots that are due. Args: radio_map: returns the map of a robot."""
        for (robot_id, topic), output in self._outputs.items():
            is_due = record.sim_time_ns >= self._due_ns[robot_id, topic]
            if is_due and output.wanted and record.is_there(robot_id):
                self._due_ns[robot_id, topic] = record.sim_time_ns + RADIO_MAP_PERIOD_NS
                values = topic.values(self._source, radio_map(robot_id), robot_id)
                for message in topic.messages(record.sim_time_ns, values):
                    output.publish(message)


class _Beginning(NamedTuple):
    """What the mission's topics show before the first step."""

    mission: MissionStatus
    victims: Sequence[Any]
    noise_db: float
    voice_map: FieldMap
    egress: Egress | None
    events: tuple[()] = ()


class _Objects(NamedTuple):
    """What /world/objects shows between two steps."""

    objects: ObjectStates


class RecordOutputs:
    """The topics of the team that show the record of a step."""

    def __init__(self, node: Node, settings: Settings) -> None:
        """Advertise."""
        self._settings = settings
        self._presence = output_of(node, ROBOTS, settings)
        scenario = settings.scenario
        has_doors = scenario.plan.doors and not settings.is_another_world  # which publishes its own
        self._outputs = {
            topic: output_of(node, topic, settings)
            for topic in (RECORD_TOPICS if settings.mission else WORLD_TOPICS)
            if topic.is_in(scenario) and (topic is not DOORS or has_doors)
        }
        self.restart()

    def restart(self) -> None:
        """Restart with the first step."""
        self._source, self._changes = Source(self._settings.setup), Changes()

    def publish_beginning(self, simulation: Simulation) -> None:
        """Publish what there is before the first step; stamp 0 shows controllers that time starts again."""
        world = simulation.world
        self.publish_presence(0, world.present, world.arrivals, world, ())
        self.publish_objects(world)
        if self._settings.mission:
            mission, voice_map = simulation.mission, simulation.hearing.sensor.map()
            beginning = _Beginning(mission.status, mission.victims, mission.noise_db, voice_map, mission.egress)
            topics = [topic for topic in (*MISSION_TOPICS, *VOICE_MAP_TOPICS) if topic in self._outputs]
            self._publish(topics, 0, beginning)

    def publish_presence(
        self,
        time_ns: int,
        present: np.ndarray,
        arrivals: Sequence[int],
        world: AnyWorld,
        failed: Sequence[int] | frozenset[int],
    ) -> None:
        """Publish which robots were present in a step, and what they cannot do or hold now."""
        values = present, arrivals, world.mishaps, failed, world.loads, self._settings.scenario.roles
        self._presence.publish(ROBOTS.message(time_ns, *values))

    def publish_objects(self, world: AnyWorld) -> None:
        """Publish all objects, unless nothing has changed."""
        self._publish([OBJECTS], 0, _Objects(world.object_states()))

    def publish(self, record: StepRecord) -> None:
        """Publish the record of a step."""
        self._publish(self._outputs, record.sim_time_ns, record)

    def _publish(self, topics: Iterable[Topic], time_ns: int, step: Any) -> None:
        for topic in topics:
            # Without a receiver no message is made: /network/links has the pairs that weakened since the last one.
            if self._outputs[topic].wanted and (topic.when is not When.CHANGE or self._changes.note(topic, step)):
                for message in topic.messages(time_ns, topic.values(self._source, step)):
                    self._outputs[topic].publish(message)
