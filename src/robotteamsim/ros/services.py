"""The services that a node offers."""

import logging
from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import rospy

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.node_parts.gate import FairLock

SERVICE_TIMEOUT_S = 5.0
"""A service waits this long for the current step [s, wall]."""

logger = logging.getLogger(__name__)


def offer(name: str, service_class: Any, serve: Callable[[Any], Any]) -> None:
    """Offer a service below the node's name, such as /simulation/pause.

    Its old name in the root namespace, such as /pause, works, too; the first call of it logs a warning.
    """
    service = rospy.Service(f"~{name}", service_class, serve)
    warned = False

    def serve_old(request: Any) -> Any:
        nonlocal warned
        if not warned:
            warned = True
            logger.warning("/%s: old name of %s; call that instead", name, service.resolved_name)
        return serve(request)

    rospy.Service(f"/{name}", service_class, serve_old)


def offer_command(name: str, service_class: Any, do: Callable[[Any], str | None], lock: FairLock | None = None) -> None:
    """Offer a service, see `offer`, whose response has `success` and `message`.

    do: carries a request out and returns the message, None for none; ValueError and a user's mistake become a failure.
    lock: held meanwhile; if it is not free in time, that is a failure, too.
    """

    def serve(request: Any) -> dict[str, Any]:
        try:
            with nullcontext() if lock is None else lock.within(SERVICE_TIMEOUT_S):
                return {"success": True, "message": do(request) or ""}
        except (ValueError, RobotTeamSimError) as error:
            return {"success": False, "message": str(error)}

    offer(name, service_class, serve)
