"""The poses of all robots for environment and mission: the ground truth, or tf where there is none."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Sequence
from typing import Protocol

from nav_msgs.msg import Odometry

from robotteamsim import _ros_transport as roscpp
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.msg import TeamState
from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.presence import Presence
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.ros.transport.synchronizer import REPORT_TIMEOUT_S, Channel, Step
from robotteamsim.ros.transport.tf_pose import TfPose, Transforms
from robotteamsim.ros.transport.topics import Input
from robotteamsim.sensing.readings import OdometryReading

logger = logging.getLogger(__name__)

TEAM_STATE = "/world/team_state"


class TeamPoses(Protocol):
    """Where a node takes the poses of all robots from."""

    @property
    def team_inputs(self) -> Sequence[Input]:
        """The topics of the team that the poses need."""

    def inputs(self, robot_id: int) -> list[Input]:
        """Return the topics of a robot that the poses need."""

    def follow(self, step: Step, presence: Presence) -> bool:
        """Process a step; return whether the poses of all present robots are known."""

    def reading(self, robot_id: int) -> OdometryReading:
        """Return pose in `map` and twist of a present robot in this step."""

    def newly_lost(self) -> list[str]:
        """Return a line for each robot that is lost since this step."""

    def restart(self) -> None:
        """Restart with the first step, because time has jumped back."""


def team_poses(settings: Settings) -> TeamPoses:
    """Return the source of poses that the scenario selects."""
    if settings.team_state:
        return WorldPoses(settings.num_robots)
    if settings.scenario.control.localisation != "tf":
        return TruePoses(settings.num_robots)
    return TfPoses(settings.num_robots, settings.scenario.control.tf_timeout_s, roscpp.TransformListener())


class WorldPoses:
    """The ground truth of all robots in one message of the world; each step waits for it."""

    team_inputs = (Input(Channel(TEAM_STATE, needed=True), TeamState),)

    def __init__(self, num_robots: int) -> None:
        self._ids = range(num_robots)
        self._readings: list[OdometryReading] = []

    def inputs(self, robot_id: int) -> list[Input]:
        """As for all sources."""
        return []

    def follow(self, step: Step, presence: Presence) -> bool:
        """As for all sources. Without lockstep, a robot that has just come may not be in the message yet."""
        state = step.latest(TEAM_STATE)
        poses, twists = state.poses, state.twists
        self._readings = [
            OdometryReading(PoseReading(*poses[4 * i : 4 * i + 4]), Twist(*twists[3 * i : 3 * i + 3]))
            for i in self._ids
        ]
        return not any(math.isnan(self._readings[i].pose.x_m) and presence.is_present(i) for i in self._ids)

    def reading(self, robot_id: int) -> OdometryReading:
        """As for all sources."""
        return self._readings[robot_id]

    def newly_lost(self) -> list[str]:
        """As for all sources."""
        return []

    def restart(self) -> None:
        """As for all sources."""


class TruePoses:
    """The ground truth; each step waits for it."""

    team_inputs = ()

    def __init__(self, num_robots: int) -> None:
        self._topics = [_truth_topic(robot_id) for robot_id in range(num_robots)]
        self._step: Step | None = None

    def inputs(self, robot_id: int) -> list[Input]:
        """As for all sources."""
        return [_odometry_input(self._topics[robot_id], robot_id, needed=True)]

    def follow(self, step: Step, presence: Presence) -> bool:
        """As for all sources."""
        self._step = step
        return True

    def reading(self, robot_id: int) -> OdometryReading:
        """As for all sources."""
        assert self._step is not None
        reading: OdometryReading = self._step.latest(self._topics[robot_id])
        return reading

    def newly_lost(self) -> list[str]:
        """As for all sources."""
        return []

    def restart(self) -> None:
        """As for all sources."""


class TfPoses:
    """For each robot the ground truth, if it is published, else its transform; steps follow the odometry.

    The pose of a lost robot is its last one: its controller stops it there.
    """

    team_inputs = ()

    def __init__(self, num_robots: int, timeout_s: float, transforms: Transforms) -> None:
        """Args: timeout_s: older ground truth does not count, and robots without a new transform are lost [s]."""
        self._transforms = transforms
        self._robots = [_Robot(robot_id, timeout_s, transforms) for robot_id in range(num_robots)]
        self._present: Sequence[_Robot] = self._robots
        self._waiting_since_s: float | None = None
        self._reported = False

    def inputs(self, robot_id: int) -> list[Input]:
        """As for all sources."""
        robot = self._robots[robot_id]
        return [
            _odometry_input(robot.odometry_topic, robot_id, needed=True),
            _odometry_input(robot.truth_topic, robot_id, needed=False),
        ]

    def follow(self, step: Step, presence: Presence) -> bool:
        """As for all sources; a wait of more than 10 s is reported once."""
        self._present = [robot for robot in self._robots if presence.is_present(robot.id)]
        for robot in self._present:
            robot.follow(step)
        missing = [robot.tf for robot in self._present if not robot.is_known]
        if not missing:
            self._waiting_since_s, self._reported = None, False
            return True
        now_s = time.monotonic()
        self._waiting_since_s = self._waiting_since_s or now_s
        if not self._reported and now_s - self._waiting_since_s >= REPORT_TIMEOUT_S:
            self._reported = True
            logger.warning("%s", _report(missing, REPORT_TIMEOUT_S))
        return False

    def reading(self, robot_id: int) -> OdometryReading:
        """As for all sources."""
        return self._robots[robot_id].reading

    def restart(self) -> None:
        """As for all sources."""
        self._transforms.clear()
        for robot in self._robots:
            robot.restart()

    def newly_lost(self) -> list[str]:
        """As for all sources."""
        return [f"{robot.lost}; using its last position" for robot in self._present if robot.is_newly_lost]


class _Robot:
    """The pose of one robot."""

    def __init__(self, robot_id: int, timeout_s: float, transforms: Transforms) -> None:
        name = robot_name(robot_id)
        self.id = robot_id
        self.odometry_topic, self.truth_topic = f"/{name}/odom", _truth_topic(robot_id)
        self.tf = TfPose(transforms, name, timeout_s)
        self._timeout_ns = round(timeout_s * 1e9)
        self.restart()

    def restart(self) -> None:
        """Forget everything."""
        self.tf.restart()
        self.lost = ""
        """Why the robot is lost; "" if it is not."""
        self.is_newly_lost = False
        self._odometry: OdometryReading | None = None
        self._truth: OdometryReading | None = None
        self._truth_ns = 0

    def follow(self, step: Step) -> None:
        """Process a step."""
        self._odometry = step.latest(self.odometry_topic) or self._odometry
        truth = step.latest(self.truth_topic)
        if truth is not None:
            self._truth, self._truth_ns = truth, step.stamp_ns
        elif step.stamp_ns - self._truth_ns >= self._timeout_ns:
            self._truth = None
        lost = self.tf.follow(step.stamp_ns) if self._truth is None else ""
        self.is_newly_lost = bool(lost and not self.lost)
        self.lost = lost

    @property
    def is_known(self) -> bool:
        """Whether the robot has been located at least once."""
        return self._truth is not None or self.tf.newest is not None

    @property
    def reading(self) -> OdometryReading:
        """Its pose in `map` and its twist."""
        if self._truth is not None:
            return self._truth
        assert self.tf.newest is not None
        assert self._odometry is not None
        return OdometryReading(self.tf.newest, self._odometry.twist)


def _report(missing: Sequence[TfPose], waited_s: float) -> str:
    names = ", ".join(tf.name for tf in missing)
    return (
        f"/tf: waited {waited_s:g} s for {names}; expected a localisation node such as amcl to publish map -> odom and "
        f"the robot odom -> base_link ({missing[0].reason.strip()})"
    )


def _truth_topic(robot_id: int) -> str:
    return f"/{robot_name(robot_id)}/base_pose_ground_truth"


def _odometry_input(topic: str, robot_id: int, *, needed: bool) -> Input:
    return Input(Channel(topic, needed=needed, robot_id=robot_id), Odometry, conversion.read_odometry)
