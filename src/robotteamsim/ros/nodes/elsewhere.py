"""Robots of the team that another world moves, such as Gazebo: their bodies in this world follow its ground truth."""

import contextlib
import logging

import numpy as np
from nav_msgs.msg import Odometry

from robotteamsim.errors import PlacementError
from robotteamsim.geometry import Twist
from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.nodes.commands import STOP
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.node import ParameterError, parameter
from robotteamsim.ros.transport.serialization import message_type
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.ros.transport.topics import message_queue
from robotteamsim.world.contract import AnyWorld

logger = logging.getLogger(__name__)


class RobotsElsewhere:
    """The robots listed in `~elsewhere`; this world does not publish their topics and ignores their commands."""

    def __init__(self, settings: Settings) -> None:
        """Subscribe. Raises: ParameterError."""
        self._ids = _ids(settings)
        self._num_robots = settings.num_robots
        self._queue = message_queue()
        for robot_id in self._ids:
            topic = f"/{robot_name(robot_id)}/base_pose_ground_truth"
            self._queue.subscribe(topic, message_type(Odometry), 1)

    def follow(self, world: AnyWorld, twists: list[Twist]) -> None:
        """Put the bodies where they are in the other world, and stop them there."""
        for index, _, data in self._queue.take(0.0) if self._ids else ():
            try:
                pose = conversion.read_odometry(data).pose.pose
            except ValueError as error:
                logger.warning("%s: ignoring a pose: %s", robot_name(self._ids[index]), error)
                continue
            # Where there is no room in this world, or if the robot is absent, the body stays where it was.
            with contextlib.suppress(PlacementError, ValueError):
                world.set_pose(self._ids[index], pose)
        for robot_id in self._ids:
            twists[robot_id] = STOP

    def published(self, present: np.ndarray | None) -> np.ndarray | None:
        """Return whether this world publishes each robot's topics, bool, shape (n,); None if it does for all.

        Args: present: whether each robot is present; None if all are.
        """
        if not self._ids:
            return present
        shown = np.ones(self._num_robots, dtype=bool) if present is None else present.copy()
        shown[list(self._ids)] = False
        return shown


def _ids(settings: Settings) -> tuple[int, ...]:
    text = parameter("~elsewhere", "")
    try:
        ids = tuple(map(int, text.split()))
    except ValueError:
        raise ParameterError(f"~elsewhere: {text!r}; expected ids of robots, separated by blanks") from None
    for robot_id in ids:
        if robot_id not in range(settings.num_robots):
            raise ParameterError(f"~elsewhere: {robot_id}; expected 0 to {settings.num_robots - 1}")
    if ids and settings.lockstep:
        raise ParameterError("~elsewhere: does not work with lockstep; expected an empty list")
    return ids
