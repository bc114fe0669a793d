"""The topics that nodes publish: rows of `recording.topics`, and those of a team whose messages are made in bulk."""

from __future__ import annotations

import itertools
import math
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from visualization_msgs.msg import MarkerArray

from robotteamsim._core.sensing import OdometryState
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.interface import Decision
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.status import MissionStatus
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics import RECORD_TOPICS, Changes, Source, Topic, When, robots
from robotteamsim.recording.topics.decisions import COMMAND, DECISION_TOPICS
from robotteamsim.recording.topics.mission import MISSION_TOPICS
from robotteamsim.recording.topics.radio import RADIO_MAP_TOPICS, VOICE_MAP_TOPICS
from robotteamsim.recording.topics.robots import BODY_TOPICS, ODOM, SCAN, TF, TRUTH
from robotteamsim.recording.topics.world import DOORS, ROBOTS, WORLD_TOPICS
from robotteamsim.ros.messages import RosTypes
from robotteamsim.ros.scene.building import object_markers
from robotteamsim.ros.settings import Settings
from robotteamsim.ros.stage import UnprefixedTypes
from robotteamsim.ros.topics import RoscppOutput, RospyOutput, serialized
from robotteamsim.sensing.readings import OdometryReading, RobotReading, TeamReadings
from robotteamsim.simulation import Simulation, StepRecord, TeamInputs
from robotteamsim.world.contract import AnyWorld

RADIO_MAP_PERIOD_NS = 10**9

_ORIGIN = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())
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


class Decided(NamedTuple):
    """The part of a step that controllers publish: of the robots by their ids."""

    sim_time_ns: int
    present: Mapping[int, bool] | np.ndarray
    decisions: Mapping[int, Decision] | Sequence[Decision]


class _Sensed(NamedTuple):
    """The part of a step that robots sense."""

    sim_time_ns: int
    present: np.ndarray
    readings: Sequence[RobotReading] = ()


StepInputs = TeamInputs | Decided | _Sensed

_BULK = {TRUTH: _ODOMETRY.itemsize, ODOM: _ODOMETRY.itemsize, SCAN: 8}
"""Topics whose messages are made in bulk, and the bytes of their numbers: pose, twist and covariances; two counts."""


Output = RospyOutput | RoscppOutput


def output_of(topic: Topic, settings: Settings, robot_id: int | None = None, kind: type[Output] = RoscppOutput) -> Any:
    """Advertise a topic of the team or of a robot."""
    name = topic.name if robot_id is None else settings.robot_topic(robot_id, topic.name)
    # In lockstep a late subscriber must still get the step that all nodes wait for.
    latched = topic.latched or (settings.lockstep and topic.when is When.STEP and topic is not TF)
    return kind(name, RosTypes().message_class(topic.type_name), latched=latched)


class RobotOutputs:
    """Topics of several robots."""

    def __init__(
        self, topics: Iterable[tuple[int, Topic]], settings: Settings, kind: type[Output] = RoscppOutput
    ) -> None:
        """Advertise topics of robots, by their ids."""
        self._make, self._source = RosTypes() if settings.prefix else UnprefixedTypes(), Source(settings.setup)
        self._outputs = [(topic, i, output_of(topic, settings, i, kind)) for i, topic in topics]

    def publish(self, step: StepInputs, only: Topic | None = None) -> None:
        """Publish the messages of the present robots that somebody receives. Args: only: one of the topics."""
        for topic, robot_id, output in self._outputs:
            if step.present[robot_id] and output.wanted and only in (None, topic):
                self._publish(output, topic, step, robot_id)

    def _publish(self, output: Any, topic: Topic, step: StepInputs, robot_id: int) -> None:
        for message in self._messages(topic, step, robot_id):
            output.publish(message)

    def _messages(self, topic: Topic, step: StepInputs, robot_id: int) -> Sequence[Any]:
        return topic.messages(self._make, step.sim_time_ns, topic.values(self._source, step, robot_id))


def decision_outputs(settings: Settings, robot_ids: Iterable[int], kind: type[Output]) -> RobotOutputs:
    """Advertise what the controllers of robots publish: `cmd_vel` only for robots that are not driven by hand."""
    rest = [topic for topic in DECISION_TOPICS if topic is not COMMAND]
    rows = [(i, topic) for i in robot_ids for topic in (rest if settings.is_driven_by_hand(i) else DECISION_TOPICS)]
    return RobotOutputs(rows, settings, kind)


class TeamOutputs(RobotOutputs):
    """What all robots sense, and their tf.

    Odometry, ground truth, scans and tf are bytes made of the team's arrays. Everything but their stamps and numbers is
    taken from messages that are made once.
    """

    def __init__(self, settings: Settings, *, localized: bool) -> None:
        """Args: localized: whether tf also has map -> odom, without error."""
        self._models = models = settings.setup.robots
        self._here = [robot_id for robot_id in range(len(models)) if robot_id not in settings.elsewhere]
        super().__init__(itertools.product(self._here, BODY_TOPICS), settings)
        self._sensors = [
            (i, sensor, {name: self._sensor_output(settings, i, name, kind) for name, kind in sensor.topics.items()})
            for i in self._here
            for sensor in models[i].sensors
        ]
        self._tf = output_of(TF, settings)
        self._localized = localized
        self._origins: Sequence[PoseReading] = ()
        still = RobotReading(_ORIGIN.pose, _ORIGIN.twist, _ORIGIN, np.zeros(0, np.float32), in_contact=False)
        begin = _Sensed(0, np.zeros(len(models), bool), [still] * len(models))
        self._heads = {
            topic: {i: _tail(self._messages(topic, begin, i)[0], size) for i in self._here}
            for topic, size in _BULK.items()
        }
        self._frames = {
            i: [_tail(frame) for frame in robots.robot_transforms(self._make, 0, i, models[i], _ORIGIN)]
            for i in self._here
        }
        self._numbers: dict[Topic, Any] = {}
        """What follows each head, by topic and robot."""

    def _sensor_output(self, settings: Settings, robot_id: int, name: str, type_name: str) -> RoscppOutput:
        return RoscppOutput(settings.robot_topic(robot_id, name), self._make.message_class(type_name))

    def publish(self, step: Any, only: Topic | None = None) -> None:
        """Publish one step's readings of the present robots on topics with subscribers."""
        readings: TeamReadings = step.readings
        state = readings.state
        self._numbers = {TRUTH: _odometry_rows(state.true_pose, state.true_twist), SCAN: readings.ranges_m}
        self._numbers[ODOM] = _odometry_rows_of(state.odometry)
        super().publish(step, only)
        for i, sensor, outputs in self._sensors:
            measured = readings.sensors.get(i, {})
            if sensor.name in measured and any(output.wanted for output in outputs.values()):
                for name, message in sensor.messages(self._make, step.sim_time_ns, i, measured[sensor.name]).items():
                    outputs[name].publish(message)
        if self._localized:
            self._origins = [_origin(reading) for reading in readings]
        self._publish_tf(step.sim_time_ns, state.odometry, step.present)

    def publish_motion(self, time_ns: int, odometry: OdometryState, present: np.ndarray) -> None:
        """Publish odometry and tf of a time between two steps."""
        self._numbers[ODOM] = _odometry_rows_of(odometry)
        super().publish(_Sensed(time_ns, present), only=ODOM)
        self._publish_tf(time_ns, odometry, present)

    def _publish(self, output: RoscppOutput, topic: Topic, step: StepInputs, robot_id: int) -> None:
        if topic not in self._heads:
            super()._publish(output, topic, step, robot_id)
            return
        numbers = self._numbers[topic][robot_id].tobytes()
        if topic is SCAN:  # their number before the ranges, and no intensities after them
            numbers = struct.pack("<I", len(numbers) // 4) + numbers + bytes(4)
        output.publish_bytes(_begin(step.sim_time_ns) + self._heads[topic][robot_id] + numbers)

    def _publish_tf(self, time_ns: int, odometry: OdometryState, present: np.ndarray) -> None:
        if not self._tf.wanted:
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
        self._tf.publish_bytes(b"".join((struct.pack("<I", count), *parts)))


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


def _odometry_rows_of(odometry: OdometryState) -> np.ndarray:
    rows = _odometry_rows(odometry.pose, odometry.twist)
    rows["pose_covariance"] = robots.pose_covariances(odometry.pose_covariance)
    rows["twist_covariance"] = robots.twist_covariances(odometry.twist_variances)
    return rows


def _origin(reading: RobotReading) -> PoseReading:
    """Return the origin of a robot's odometry in `map`."""
    if math.isnan(reading.ground_truth.x_m):
        return _ORIGIN.pose  # of a robot that is not present; it is not published
    return PoseReading.from_pose(reading.ground_truth.pose @ reading.odometry.pose.pose.inverse())


class RadioMapOutputs:
    """The signal of each robot over the floor, once a second for subscribers."""

    def __init__(self, settings: Settings, robot_ids: Iterable[int]) -> None:
        """Advertise."""
        self._make, self._source = RosTypes(), Source(settings.setup)
        self._outputs = {(i, topic): output_of(topic, settings, i) for i in robot_ids for topic in RADIO_MAP_TOPICS}
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
                for message in topic.messages(self._make, record.sim_time_ns, values):
                    output.publish(message)


class _Beginning(NamedTuple):
    """What the mission's topics show before the first step."""

    mission: MissionStatus
    victims: Sequence[Any]
    noise_db: float
    voice_map: FieldMap
    egress: Egress | None
    events: tuple[()] = ()


class RecordOutputs:
    """The topics of the team that show the record of a step."""

    def __init__(self, settings: Settings) -> None:
        """Advertise."""
        self._settings = settings
        self._make = RosTypes()
        self._presence = output_of(ROBOTS, settings)
        self._objects = RoscppOutput("/world/objects", MarkerArray, latched=True)
        scenario = settings.scenario
        has_doors = scenario.plan.doors and not settings.is_another_world  # which publishes its own
        self._outputs = {
            topic: output_of(topic, settings)
            for topic in (RECORD_TOPICS if settings.mission else WORLD_TOPICS)
            if topic.is_in(scenario) and (topic is not DOORS or has_doors)
        }
        self.restart()

    def restart(self) -> None:
        """Restart with the first step."""
        self._source, self._changes = Source(self._settings.setup), Changes()
        self._shown_objects: tuple[Any, ...] = ()

    def publish_beginning(self, simulation: Simulation) -> None:
        """Publish what there is before the first step; stamp 0 tells controllers that time starts again."""
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
        self._presence.publish(ROBOTS.message(self._make, time_ns, *values))

    def publish_objects(self, world: AnyWorld) -> None:
        """Publish all objects, unless nothing has changed."""
        objects, poses = world.object_models(), tuple(world.objects().values())
        if (objects, poses) != self._shown_objects:
            replace = not self._shown_objects or objects != self._shown_objects[0]
            self._objects.publish(object_markers(objects, poses, replace=replace))
            self._shown_objects = objects, poses

    def publish(self, record: StepRecord) -> None:
        """Publish the record of a step."""
        self._publish(self._outputs, record.sim_time_ns, record)

    def _publish(self, topics: Iterable[Topic], time_ns: int, step: Any) -> None:
        for topic in topics:
            # Without a receiver no message is made: /network/links has the pairs that weakened since the last one.
            if self._outputs[topic].wanted and (topic.when is not When.CHANGE or self._changes.note(topic, step)):
                for message in topic.messages(self._make, time_ns, topic.values(self._source, step)):
                    self._outputs[topic].publish(message)
