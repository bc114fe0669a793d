"""Serves the viewer, by default on this machine only: a recorded mission as one page, or a live one."""

from __future__ import annotations

import secrets
import socket
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar

import msgspec

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.view.html import MODULES, PAGE
from robotteamsim.view.live import AnyCommand
from robotteamsim.view.shown import ShownMission

HOST = "127.0.0.1"
_MAX_COMMAND_BYTES = 10_000
_SCRIPTS = {f"page/{name}.js": PAGE / f"{name}.js" for name in (*MODULES, "three.min")}
_COMMANDS: msgspec.json.Decoder[AnyCommand] = msgspec.json.Decoder(AnyCommand)
_KEEP_ALIVE_S = 5.0
_REFUSED = "only for the viewer's own page: open the whole address that was printed"
_ALL_ADDRESSES = ("0.0.0.0", "::")
_NO_COMMAND = "not a command of the page of a live mission"


# aiohttp or starlette would save few of these lines, and need an event loop next to the threads of missions.
class ViewServer(ThreadingHTTPServer):
    """Answers browsers of this machine or, at a chosen address, all browsers that know a secret token."""

    daemon_threads = True

    def __init__(self, port: int, page: str, mission: ShownMission | None = None, host: str | None = None) -> None:
        """Args: port: 0 for a free one.  page: the HTML page.  mission: None for a page with recorded missions.

        host: listen at this address; then each path begins with a new token, without which no request is answered.
        Raises: RobotTeamSimError: the port is in use, or this machine does not have the address.
        """
        self.page, self.mission, self.host = page.encode(), mission, (host or HOST).lower()
        self.address_family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        try:
            super().__init__((self.host, port), _Handler)
        except (OSError, OverflowError, TypeError) as error:
            why = getattr(error, "strerror", None) or error
            raise RobotTeamSimError(f"host {self.host}, port {port}: {why}") from None
        self.root = f"/{secrets.token_urlsafe(16)}/" if host else "/"
        """The path of the page, with which all other paths begin."""

    @property
    def url(self) -> str:
        """The address of the page."""
        name = socket.gethostname() if self.host in _ALL_ADDRESSES else self.host
        return f"http://{f'[{name}]' if ':' in name else name}:{self.server_address[1]}{self.root}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a browser that has gone."""


class _Handler(BaseHTTPRequestHandler):
    server: ViewServer
    protocol_version = "HTTP/1.1"
    server_version = "robotteamsim"
    timeout = 30.0
    """A browser that stops within a request is left [s]."""
    _HEADERS: ClassVar = {
        "Cache-Control": "no-store",
        "Referrer-Policy": "same-origin",
        "X-Content-Type-Options": "nosniff",
    }

    def do_GET(self) -> None:
        """Answer a request for the page, one of its scripts, or the frames."""
        path = self._path()
        if path is None:
            self._reply(HTTPStatus.FORBIDDEN, _REFUSED.encode(), "text/plain")
        elif path == "":
            self._reply(HTTPStatus.OK, self.server.page, "text/html; charset=utf-8")
        elif path in _SCRIPTS:
            self._reply(HTTPStatus.OK, _SCRIPTS[path].read_bytes(), "text/javascript; charset=utf-8")
        elif path == "mission.html" and self.server.mission is not None:
            self._send_page(self.server.mission)
        elif path == "frames" and self.server.mission is not None:
            self._send_frames(self.server.mission)
        else:
            self._reply(HTTPStatus.NOT_FOUND, b"not found", "text/plain")

    def do_POST(self) -> None:
        """Execute a command of the page."""
        mission, path = self.server.mission, self._path()
        # A page from elsewhere can send JSON only after a CORS preflight, which this server rejects.
        is_json = self.headers.get("Content-Type") == "application/json"
        if mission is None or path != "command" or not is_json:
            self.close_connection = True  # the body has not been read
            why = _REFUSED if path is None else _NO_COMMAND
            self._reply(HTTPStatus.FORBIDDEN, msgspec.json.encode({"error": why}), "application/json")
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or len(length) > 5 or int(length) > _MAX_COMMAND_BYTES:
            self.close_connection = True
            self._reply(HTTPStatus.BAD_REQUEST, b'{"error": "the command is too long"}', "application/json")
            return
        error = _execute(mission, self.rfile.read(int(length)))
        status = HTTPStatus.BAD_REQUEST if error else HTTPStatus.OK
        self._reply(status, msgspec.json.encode({"error": error}), "application/json")

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing."""

    def _path(self) -> str | None:
        """Return the requested path below that of the page; None if the request is refused.

        Pages of other sites are refused and, without a token, names that lead here (DNS rebinding). Not every browser
        sends `Sec-Fetch-Site`, and none sends `Origin` for its own address bar or a picture.
        """
        root, host = self.server.root, self.headers.get("Host", "")
        own_page = f"http://{host}"
        is_ours = (
            secrets.compare_digest(self.path[: len(root)].encode(), root.encode())
            and (root != "/" or host.partition(":")[0] in (HOST, "localhost"))
            and self.headers.get("Origin", own_page) == own_page
            and self.headers.get("Sec-Fetch-Site", "none") in ("none", "same-origin")
        )
        return self.path[len(root) :] if is_ours else None

    def _send_page(self, mission: ShownMission) -> None:
        try:
            self._reply(HTTPStatus.OK, mission.page().encode(), "text/html; charset=utf-8")
        except ValueError as error:
            self._reply(HTTPStatus.BAD_REQUEST, str(error).encode(), "text/plain")

    def _send_frames(self, mission: ShownMission) -> None:
        self.close_connection = True
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/event-stream")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        viewer = mission.subscribe()
        try:
            while (update := mission.take(viewer, _KEEP_ALIVE_S)) is not None or not mission.is_closed:
                # A comment finds out whether the browser is still there.
                data = b": \n\n" if update is None else b"data: " + msgspec.json.encode(update) + b"\n\n"
                self.wfile.write(data)
        except OSError:
            return
        finally:
            mission.unsubscribe(viewer)

    def _reply(self, status: HTTPStatus, body: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        for name, value in self._HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)


def _execute(mission: ShownMission, text: bytes) -> str:
    """Execute a command; return what is wrong with it, or ""."""
    try:
        mission.execute(_COMMANDS.decode(text))
    except (msgspec.ValidationError, msgspec.DecodeError, RobotTeamSimError, ValueError) as error:
        return str(error)
    except Exception as error:  # any error of a mission is shown in the page
        return f"{type(error).__name__}: {error}"
    return ""
