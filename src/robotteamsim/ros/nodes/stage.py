"""What users of stage_ros expect of the world: names without a prefix for a single robot, and a topic for the speed."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Any

from std_msgs.msg import String

from robotteamsim.recording.ros_messages import robot_name
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.serialization import deserialized, message_type
from robotteamsim.ros.transport.topics import message_queue

REQUESTS = "/stageGUIRequest"
SPEEDUP = "speedup"
DEFAULT_SPEEDUP = 2.0
"""Of a request without a number."""
MAX_REQUESTS = 10
POLL_S = 1.0

logger = logging.getLogger(__name__)


def robot_topic(robot_id: int, name: str, *, prefix: bool) -> str:
    """Return the full name of a robot's topic: /robot_0/odom, or /odom."""
    return f"/{robot_name(robot_id)}/{name}" if prefix else f"/{name}"


class UnprefixedTypes(RosTypes):
    """Messages of a single robot, whose frames have no prefix: base_link instead of robot_0/base_link."""

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message, as `Make` does."""
        for key in ("frame_id", "child_frame_id"):
            if key in attributes:
                attributes[key] = attributes[key].removeprefix(f"{robot_name(0)}/")
        return super().__call__(type_name, **attributes)


def requested_speed(request: str) -> float | None:
    """Return the speed of a request such as `speedup_4.0`; None for a request that is not about the speed.

    Raises: ValueError: the speed is not a number.
    """
    kind, _, number = request.strip().partition("_")
    if kind != SPEEDUP:
        return None
    try:
        return float(number) if number else DEFAULT_SPEEDUP
    except ValueError:
        raise ValueError(f"{number!r} is not a number") from None


class StageRequests:
    """Follows the requests on /stageGUIRequest, in a thread of its own."""

    def __init__(self, set_speed: Callable[[float], None]) -> None:
        """Args: set_speed: sets simulated over wall time; raises ValueError for a wrong one."""
        self._set_speed = set_speed
        self._queue = message_queue()
        self._queue.subscribe(REQUESTS, message_type(String), MAX_REQUESTS)
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while not self._queue.is_closed:
            for _, _, data in self._queue.take(POLL_S):
                try:
                    self.follow(deserialized(String, data).data)
                except ValueError as error:
                    logger.warning("%s: ignoring a request that cannot be read: %s", REQUESTS, error)

    def follow(self, request: str) -> None:
        """Set the requested speed; ignore requests about Stage's window, such as `footprints` and `screenshot`."""
        try:
            speed = requested_speed(request)
            if speed is not None:
                self._set_speed(speed)
                logger.info("speed %g", speed)
        except ValueError as error:
            logger.warning("%s: ignoring %.60r: %s", REQUESTS, request, error)
