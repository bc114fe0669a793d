"""What users of stage_ros expect of the world: names without a prefix for a single robot, and a topic for the speed."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from std_msgs.msg import String

from robotteamsim.message_parts import robot_name
from robotteamsim.ros.inputs import Input
from robotteamsim.ros.messages import RosTypes

REQUESTS = "/stageGUIRequest"
SPEEDUP = "speedup"
DEFAULT_SPEEDUP = 2.0
"""Of a request without a number."""

logger = logging.getLogger(__name__)


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
    """Follows the requests on /stageGUIRequest."""

    def __init__(self, set_speed: Callable[[float], None]) -> None:
        """Args: set_speed: sets simulated over wall time; raises ValueError for a wrong one."""
        self._set_speed = set_speed
        Input(REQUESTS, String, lambda message: message.data).listen(lambda _, __, request: self.follow(request))

    def follow(self, request: str) -> None:
        """Set the requested speed; ignore requests about Stage's window, such as `footprints` and `screenshot`."""
        try:
            speed = requested_speed(request)
            if speed is not None:
                self._set_speed(speed)
                logger.info("speed %g", speed)
        except ValueError as error:
            logger.warning("%s: ignoring %.60r: %s", REQUESTS, request, error)
