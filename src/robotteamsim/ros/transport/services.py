"""The services that a node offers and calls."""

import logging
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from robotteamsim import _ros_transport as roscpp
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.ros.transport.serialization import deserialized, serialized, service_type

logger = logging.getLogger(__name__)


class Service:
    """A service of a node; each request is served in a new thread."""

    def __init__(self, name: str, service_class: Any, serve: Callable[[Any], Any]) -> None:
        """Advertise. serve: returns the response to a request, messages of the class."""
        self._name = name
        self._request_class = service_class._request_class
        self._serve = serve
        self._server = roscpp.ServiceServer(name, service_type(service_class), self._respond)

    def _respond(self, data: bytes) -> bytes:
        try:
            return serialized(self._serve(deserialized(self._request_class, data)))
        except Exception:  # The caller receives the error; the node continues.
            logger.exception("%s failed", self._name)
            raise


def command(
    name: str, service_class: Any, do: Callable[[Any], str | None], lock: AbstractContextManager[Any] | None = None
) -> Service:
    """Offer a service whose response has `success` and `message`.

    do: carries a request out and returns the message, None for none; ValueError and a user's mistake become a failure.
    lock: held meanwhile.
    """
    response = service_class._response_class

    def serve(request: Any) -> Any:
        try:
            with lock or nullcontext():
                return response(success=True, message=do(request) or "")
        except (ValueError, RobotTeamSimError) as error:
            return response(success=False, message=str(error))

    return Service(name, service_class, serve)


def call_service(name: str, service_class: Any, request: Any, timeout_s: float) -> Any | None:
    """Call a service; None if it is not available in time [s, wall] or has failed."""
    response = roscpp.call_service(name, service_type(service_class), serialized(request), timeout_s)
    return None if response is None else deserialized(service_class._response_class, response)
