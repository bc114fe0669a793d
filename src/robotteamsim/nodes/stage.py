"""What users of stage_ros expect of the world: names without a prefix for a single robot, and a topic for the speed."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from robotteamsim.message_parts import Make, robot_name
from robotteamsim.nodes.inputs import Input
from robotteamsim.nodes.node import Node

REQUESTS = "/stageGUIRequest"
SPEEDUP = "speedup"
DEFAULT_SPEEDUP = 2.0
"""Of a request without a number."""

logger = logging.getLogger(__name__)


class Unprefixed:
    """Makes messages of a robot whose frames have no prefix: base_link instead of robot_0/base_link."""

    def __init__(self, make: Make, robot_id: int) -> None:
        """Args: make: makes the messages."""
        self._make = make
        self._prefix = f"{robot_name(robot_id)}/"
        self.time, self.duration = make.time, make.duration

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message, as `Make` does."""
        for key in ("frame_id", "child_frame_id"):
            if key in attributes:
                attributes[key] = attributes[key].removeprefix(self._prefix)
        return self._make(type_name, **attributes)


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
