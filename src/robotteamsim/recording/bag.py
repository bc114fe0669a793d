"""Topics and messages of a headless run: those of a ROS run."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from robotteamsim.errors import RecordingError
from robotteamsim.message_parts import robot_name
from robotteamsim.recording.topics import ROBOT_TOPICS, TEAM_TOPICS, Changes, Source
from robotteamsim.recording.topics.world import CLOCK, clock, level_maps
from robotteamsim.scenario.map_image import check_published_map
from robotteamsim.scenario.sensors.base import messages_of
from robotteamsim.setup import Setup
from robotteamsim.simulation import StepRecord

_OF_TEAM = tuple(topic for topic in TEAM_TOPICS if topic is not CLOCK)


MOST_ROBOTS = 1000
"""In a file with these topics: rosbags compares each new topic with all before, which would take minutes."""


class BagTopic(NamedTuple):
    """A topic of the bag."""

    name: str
    type_name: str
    latched: bool


def check_size(path: Path, setup: Setup) -> None:
    """Raises: RecordingError: the team has too many topics for a file."""
    if len(setup.robots) > MOST_ROBOTS:
        text = f"{len(setup.robots)} robots have too many topics for one file; expected at most {MOST_ROBOTS}"
        raise RecordingError(f"{path}: {text} (robots.count)")


class BagMessages:
    """The messages of a trial, step by step."""

    def __init__(self, setup: Setup, *, localized: bool = False) -> None:
        """Prepare the messages. Args: localized: as in `Source`.

        Raises: ScenarioError: /map would have too many cells.
        """
        check_published_map(setup.scenario)
        self._scenario, self._robots = setup.scenario, setup.robots
        self._step_ns = round(setup.scenario.run.step_s * 1e9)
        self._source = Source(setup, localized=localized)
        self._changes = Changes()
        self._team = [topic for topic in _OF_TEAM if topic.is_in(setup.scenario)] + level_maps(setup.scenario)
        self._of_robot = [topic for topic in ROBOT_TOPICS if topic.in_bags and topic.is_in(setup.scenario)]
        self._names = [f"/{robot_name(robot_id)}/" for robot_id in range(len(setup.robots))]

    def topics(self) -> Iterator[BagTopic]:
        """Yield all topics of the team and of each robot."""
        for topic in (CLOCK, *self._team):
            yield BagTopic(topic.name, topic.type_name, topic.latched)
        for prefix, robot in zip(self._names, self._robots, strict=True):
            for of_robot in self._of_robot:
                yield BagTopic(prefix + of_robot.name, of_robot.type_name, of_robot.latched)
            for sensor in robot.sensors:
                for name, type_name in sensor.topics.items():
                    yield BagTopic(prefix + name, type_name, latched=False)

    def of_step(self, record: StepRecord) -> Iterator[tuple[int, str, Any]]:
        """Yield time [ns], topic and message in the order in which the nodes publish; the clock of the step is last."""
        time_ns, ticks = record.sim_time_ns, self._scenario.run.physics_substeps
        for tick in range(1, ticks):
            tick_ns = time_ns - self._step_ns + tick * self._step_ns // ticks
            yield tick_ns, CLOCK.name, clock(tick_ns)
        for topic in self._team:
            if not self._changes.note(topic, record):
                continue
            for message in topic.messages(time_ns, topic.values(self._source, record)):
                yield time_ns, topic.name, message
        for robot_id, prefix in enumerate(self._names):
            if record.is_there(robot_id):
                for name, message in self._robot_messages(record, robot_id):
                    yield time_ns, prefix + name, message
        yield time_ns, CLOCK.name, clock(time_ns)

    def _robot_messages(self, record: StepRecord, robot_id: int) -> Iterator[tuple[str, Any]]:
        time_ns = record.sim_time_ns
        for topic in self._of_robot:
            for message in topic.messages(time_ns, topic.values(self._source, record, robot_id)):
                yield topic.name, message
        measured = record.readings[robot_id].sensors
        for sensor in self._robots[robot_id].sensors:
            if sensor.name in measured:
                step_s = self._scenario.run.step_s
                yield from messages_of(sensor, time_ns, robot_id, measured[sensor.name], step_s).items()
