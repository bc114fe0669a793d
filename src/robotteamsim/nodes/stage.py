"""What users of stage_ros expect of the world: names without a prefix for a single robot, and a topic for the speed."""

from __future__ import annotations

import logging
from collections.abc import Callable

from robotteamsim.message_parts import RosMessage, robot_name
from robotteamsim.nodes.inputs import Input
from robotteamsim.nodes.node import Node

REQUESTS = "/stageGUIRequest"
SPEEDUP = "speedup"
DEFAULT_SPEEDUP = 2.0
"""Of a request without a number."""

logger = logging.getLogger(__name__)


def unprefixed(message: RosMessage, robot_id: int) -> RosMessage:
    """Return a message of a robot with frames that have no prefix: base_link instead of robot_0/base_link."""
    prefix, found = f"{robot_name(robot_id)}/", dict(message)
    for key in found.keys() & ("frame_id", "child_frame_id"):
        found[key] = found[key].removeprefix(prefix)
    if "header" in found:
        found["header"] = unprefixed(found["header"], robot_id)
    return found


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
    """Follows the requests on /stageGUIRequest."""

    def __init__(self, node: Node, set_speed: Callable[[float], None]) -> None:
        """Args: set_speed: sets simulated over wall time; raises ValueError for a wrong one."""
        self._set_speed = set_speed
        requests = Input(node, REQUESTS, "std_msgs/String", lambda message: message.data)
        requests.listen(lambda _, __, request: self.follow(request))

    def follow(self, request: str) -> None:
        """Set the requested speed; ignore requests about Stage's window, such as `footprints` and `screenshot`."""
        try:
            speed = requested_speed(request)
            if speed is not None:
                self._set_speed(speed)
                logger.info("speed %g", speed)
        except ValueError as error:
            logger.warning("%s: ignoring %.60r: %s", REQUESTS, request, error)
