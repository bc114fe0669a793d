"""Topics and messages of a headless run: those of a ROS run."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from robotteamsim.network.compact import LinksEncoder
from robotteamsim.recording import network_messages, ros_messages
from robotteamsim.recording.bag_types import BagTypes
from robotteamsim.recording.hazard_messages import FIRE_GRID, SMOKE_GRID, SOOT, TEMPERATURE, hazard_messages
from robotteamsim.recording.sensor_messages import sensor_topics
from robotteamsim.scenario.published_map import published_map
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import StepRecord
from robotteamsim.world.placement import placed_robots


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of the bag."""

    name: str
    type_name: str
    latched: bool = False


TEAM_TOPICS = (
    Topic("/clock", "rosgraph_msgs/Clock"),
    Topic("/tf", "tf2_msgs/TFMessage"),
    Topic("/map", "nav_msgs/OccupancyGrid", latched=True),
    Topic("/voice_map", "nav_msgs/OccupancyGrid", latched=True),
    Topic("/voice_map/values", "robotteamsim/FloatMap", latched=True),
    Topic("/network/links", "robotteamsim/NetworkLinks"),
    Topic("/network/state", "robotteamsim/NetworkState"),
    Topic("/mission/status", "robotteamsim/MissionStatus"),
    Topic("/mission/events", "robotteamsim/MissionEvent"),
    Topic("/mission/victims", "robotteamsim/Victims", latched=True),
    Topic("/mission/areas", "robotteamsim/Areas", latched=True),
    Topic("/world/doors", "robotteamsim/Doors", latched=True),
    Topic("/world/robots", "robotteamsim/Robots", latched=True),
    Topic("/world/people", "robotteamsim/People", latched=True),
)

FIRE_TOPICS = (
    Topic(FIRE_GRID, "nav_msgs/OccupancyGrid", latched=True),
    Topic(TEMPERATURE, "robotteamsim/FloatMap", latched=True),
    Topic(SMOKE_GRID, "nav_msgs/OccupancyGrid", latched=True),
    Topic(SOOT, "robotteamsim/FloatMap", latched=True),
)
"""Of scenarios with a fire."""

ROBOT_TOPICS = (
    Topic("odom", "nav_msgs/Odometry"),
    Topic("base_scan", "sensor_msgs/LaserScan"),
    Topic("base_pose_ground_truth", "nav_msgs/Odometry"),
    Topic("contact", "robotteamsim/Contact"),
    Topic("voice", "robotteamsim/Voice"),
    Topic("network/tx", "robotteamsim/NetworkMessages"),
    Topic("network/rx", "robotteamsim/NetworkMessages"),
    Topic("cmd_vel", "geometry_msgs/Twist"),
    Topic("controller/status", "robotteamsim/ControllerStatus"),
    Topic("controller/belief", "nav_msgs/OccupancyGrid", latched=True),
)
"""Topics in the namespace of each robot."""


_PRESENCE = ("present", "arrivals", "mishaps", "loads")
"""Members of a record that /world/robots shows."""


class BagMessages:
    """The messages of a trial, step by step."""

    def __init__(self, scenario: Scenario, make: BagTypes) -> None:
        self._scenario = scenario
        self._robots = placed_robots(scenario)
        self._sensors = [sensor_topics(robot) for robot in self._robots]
        self._step_ns = round(scenario.run.step_s * 1e9)
        self._last: StepRecord | None = None
        self._encoder = LinksEncoder()
        self._make = make

    def topics(self) -> Iterator[Topic]:
        """Yield all topics of the team and of each robot."""
        left_out = set() if self._scenario.network.publish_matrices else {"/network/state"}
        left_out |= set() if self._scenario.moves_people else {"/world/people"}
        yield from (topic for topic in TEAM_TOPICS if topic.name not in left_out)
        if self._scenario.fire is not None:
            yield from FIRE_TOPICS
        for robot_id, sensors in enumerate(self._sensors):
            for topic in (*ROBOT_TOPICS, *(Topic(sensor.name, sensor.type_name) for sensor in sensors)):
                yield Topic(f"/{ros_messages.robot_name(robot_id)}/{topic.name}", topic.type_name, topic.latched)

    def of_step(self, record: StepRecord) -> Iterator[tuple[int, str, Any]]:
        """Yield time [ns], topic and message in the order in which the nodes publish; the clock of the step is last."""
        make, time_ns = self._make, record.sim_time_ns
        ticks = self._scenario.run.physics_substeps
        for tick in range(1, ticks):
            tick_ns = time_ns - self._step_ns + tick * self._step_ns // ticks
            yield tick_ns, "/clock", ros_messages.clock(make, tick_ns)
        for topic, message in self._team_messages(record):
            yield time_ns, topic, message
        for robot_id in range(len(self._robots)):
            if not record.is_there(robot_id):
                continue
            for topic, message in self._robot_messages(record, robot_id):
                yield time_ns, f"/{ros_messages.robot_name(robot_id)}/{topic}", message
        yield time_ns, "/clock", ros_messages.clock(make, time_ns)

    def _team_messages(self, record: StepRecord) -> Iterator[tuple[str, Any]]:
        make, time_ns, status, last = self._make, record.sim_time_ns, record.mission, self._last
        if last is None:
            grid = published_map(self._scenario)
            yield "/map", ros_messages.occupancy_grid(make, time_ns, grid)
        odometry = [
            reading.odometry if record.is_there(robot_id) else None for robot_id, reading in enumerate(record.readings)
        ]
        yield "/tf", ros_messages.transforms(make, time_ns, self._robots, odometry)
        if record.doors and (last is None or record.doors.version != last.doors.version):
            yield "/world/doors", ros_messages.doors(make, time_ns, record.doors)
        if last is None or any(getattr(record, name) is not getattr(last, name) for name in _PRESENCE):
            yield (
                "/world/robots",
                ros_messages.robots(
                    make, time_ns, record.present, record.arrivals, record.mishaps, record.failed, record.loads
                ),
            )
        if record.hazards is not None:
            yield from hazard_messages(make, time_ns, record.hazards)
        if record.people and (last is None or record.people is not last.people):
            yield "/world/people", ros_messages.people(make, time_ns, record.people)
        if record.voice_map is not None:
            yield "/voice_map", ros_messages.field_map_picture(make, time_ns, record.voice_map)
            yield "/voice_map/values", ros_messages.field_map(make, time_ns, record.voice_map, "voice_level", "dB")
        yield "/network/links", network_messages.network_links(make, time_ns, self._encoder.encode(record.network))
        if self._scenario.network.publish_matrices:
            yield "/network/state", network_messages.network_state(make, time_ns, record.network)
        yield (
            "/mission/status",
            ros_messages.mission_status(make, time_ns, self._scenario.name, status, record.noise_db),
        )
        for event in record.events:
            yield "/mission/events", ros_messages.mission_event(make, time_ns, event)
        if last is None or (record.victims, status.victims) != (last.victims, last.mission.victims):
            yield "/mission/victims", ros_messages.victims(make, time_ns, record.victims, status.victims)
        if last is None or status.explored != last.mission.explored:
            yield "/mission/areas", ros_messages.areas(make, time_ns, self._scenario.mission.areas, status)
        self._last = record

    def _robot_messages(self, record: StepRecord, robot_id: int) -> Iterator[tuple[str, Any]]:
        make, time_ns = self._make, record.sim_time_ns
        robot, reading, decision = self._robots[robot_id], record.readings[robot_id], record.decisions[robot_id]
        yield "odom", ros_messages.odometry(make, time_ns, robot_id, reading.odometry)
        yield "base_scan", ros_messages.scan(make, time_ns, robot_id, robot.laser, reading.ranges_m)
        yield "base_pose_ground_truth", ros_messages.ground_truth(make, time_ns, robot_id, reading)
        yield "contact", ros_messages.contact(make, time_ns, robot_id, reading.in_contact, reading.contact_angles_rad)
        for topic in self._sensors[robot_id]:
            message = topic.message(make, time_ns, robot_id, reading.further)
            if message is not None:
                yield topic.name, message
        yield "voice", ros_messages.voice(make, time_ns, record.voices[robot_id])
        yield "network/rx", network_messages.network_messages(make, time_ns, record.inboxes[robot_id])
        yield "network/tx", network_messages.network_messages(make, time_ns, decision.outbox)
        yield "cmd_vel", ros_messages.twist(make, decision.twist)
        yield "controller/status", ros_messages.controller_status(make, time_ns, robot_id, decision)
        if decision.belief is not None:
            yield "controller/belief", ros_messages.field_map_picture(make, time_ns, decision.belief)
