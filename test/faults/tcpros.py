"""A publisher of arbitrary bytes on any topic, by the protocol TCPROS itself.

A client library would not send a frame that is shorter or longer than it claims. Each subscriber has its own
connection, so a message goes to one chosen node.
"""

from __future__ import annotations

import contextlib
import socket
import struct
import threading
from dataclasses import dataclass
from socketserver import ThreadingMixIn
from typing import Any
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

SEND_TIMEOUT_S = 5.0
"""A node that reads nothing for this long hangs [s, wall]."""
HANDSHAKE_TIMEOUT_S = 10.0
OK = 1


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic and the description of its type, as in a connection header."""

    name: str
    type_name: str
    md5sum: str


@dataclass(slots=True)
class Connection:
    """One subscriber of one topic."""

    topic: Topic
    node: str
    link: socket.socket

    def send(self, data: bytes, claimed: int | None = None) -> None:
        """Send a frame. claimed: the length that it claims, if not its own. Raises: OSError; TimeoutError: it hangs."""
        self.link.sendall(struct.pack("<I", len(data) if claimed is None else claimed) + data)


class _Server(ThreadingMixIn, SimpleXMLRPCServer):
    daemon_threads = True


class RawPublisher:
    """A node that advertises topics and keeps one connection for each subscriber."""

    def __init__(self, name: str, master_uri: str) -> None:
        self._name = name
        self._master = ServerProxy(master_uri)
        self._topics: dict[str, Topic] = {}
        self._lock = threading.Lock()
        self._connections: list[Connection] = []
        self._listener = socket.create_server(("localhost", 0))
        self._server = _Server(("localhost", 0), logRequests=False, allow_none=True)
        self._server.register_function(self._request_topic, "requestTopic")
        self._server.register_function(lambda *_: [OK, "", 0], "publisherUpdate")
        self._uri = f"http://localhost:{self._server.server_address[1]}/"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def connections(self) -> list[Connection]:
        """The connections that are open now."""
        with self._lock:
            return list(self._connections)

    def advertise(self, topic: Topic) -> None:
        """Publish a topic; its subscribers connect after a moment."""
        self._topics[topic.name] = topic
        self._master.registerPublisher(self._name, topic.name, topic.type_name, self._uri)

    def advertise_again(self, name: str) -> None:
        """Publish a topic again: roscpp does not connect again by itself after a frame of more than 1 GB."""
        self._master.unregisterPublisher(self._name, name, self._uri)
        self.advertise(self._topics[name])

    def drop(self, connection: Connection) -> None:
        """Close a connection; the subscriber connects again after a moment."""
        with self._lock, contextlib.suppress(ValueError):
            self._connections.remove(connection)
        connection.link.close()

    def close(self) -> None:
        """Withdraw all topics."""
        for name in self._topics:
            with contextlib.suppress(OSError):
                self._master.unregisterPublisher(self._name, name, self._uri)
        self._server.shutdown()
        self._server.server_close()
        self._listener.close()
        for connection in self.connections:
            self.drop(connection)

    def _request_topic(self, _: str, topic: str, __: Any) -> list[Any]:
        if topic not in self._topics:
            return [0, "not published", 0]
        return [OK, "", ["TCPROS", "localhost", self._listener.getsockname()[1]]]

    def _accept(self) -> None:
        with contextlib.suppress(OSError):  # it is closed
            while True:
                link, _ = self._listener.accept()
                threading.Thread(target=self._shake_hands, args=(link,), daemon=True).start()

    def _shake_hands(self, link: socket.socket) -> None:
        link.settimeout(HANDSHAKE_TIMEOUT_S)
        try:
            header = _read_header(link)
            topic = self._topics[header["topic"]]
            link.sendall(_header(callerid=self._name, md5sum=topic.md5sum, type=topic.type_name, latching="0"))
        except (OSError, KeyError, ValueError, struct.error):
            link.close()
            return
        link.settimeout(SEND_TIMEOUT_S)
        with self._lock:
            self._connections.append(Connection(topic, header["callerid"], link))


def _header(**fields: str) -> bytes:
    entries = (f"{key}={value}".encode() for key, value in fields.items())
    body = b"".join(struct.pack("<I", len(entry)) + entry for entry in entries)
    return struct.pack("<I", len(body)) + body


def _read_header(link: socket.socket) -> dict[str, str]:
    body = _read(link, *struct.unpack("<I", _read(link, 4)))
    fields = {}
    while body:
        length = struct.unpack_from("<I", body)[0]
        key, _, value = body[4 : 4 + length].decode().partition("=")
        fields[key], body = value, body[4 + length :]
    return fields


def _read(link: socket.socket, count: int) -> bytes:
    data = b""
    while len(data) < count:
        if not (more := link.recv(count - len(data))):
            raise ConnectionError("closed")
        data += more
    return data
