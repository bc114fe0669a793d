"""The services that a node offers."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import rospy

from robotteamsim.errors import RobotTeamSimError


def command(
    name: str, service_class: Any, do: Callable[[Any], str | None], lock: AbstractContextManager[Any] | None = None
) -> None:
    """Offer a service whose response has `success` and `message`.

    do: carries a request out and returns the message, None for none; ValueError and a user's mistake become a failure.
    lock: held meanwhile.
    """

    def serve(request: Any) -> dict[str, Any]:
        try:
            with lock or nullcontext():
                return {"success": True, "message": do(request) or ""}
        except (ValueError, RobotTeamSimError) as error:
            return {"success": False, "message": str(error)}

    rospy.Service(name, service_class, serve)
