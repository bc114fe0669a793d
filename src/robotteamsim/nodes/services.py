"""Services that change a simulation, or refuse to."""

from collections.abc import Callable
from typing import Any

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.nodes.node import Node
from robotteamsim.wording import printable

SERVICE_TIMEOUT_S = 5.0
"""A service waits this long for the current step [s, wall]."""


def offer_command(node: Node, name: str, type_name: str, do: Callable[[Any], str | None]) -> None:
    """Offer a service below the node's name whose response has `success` and `message`.

    do: carries a request out and returns the message, None for none; ValueError and a user's mistake become a failure.
    """

    def serve(request: Any) -> dict[str, Any]:
        try:
            return {"success": True, "message": do(request) or ""}
        except (ValueError, RobotTeamSimError) as error:
            return refused(error)

    node.offer(f"~{name}", type_name, serve)


def refused(error: ValueError | RobotTeamSimError) -> dict[str, Any]:
    """Return the response of a service that refuses a request: one line, although names in it have any characters."""
    return {"success": False, "message": printable(str(error))}
