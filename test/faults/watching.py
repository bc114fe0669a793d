"""What the nodes of a launch do: their processes, their memory, and the messages that they publish."""

from __future__ import annotations

import contextlib
import re
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import rosgraph
import rospy
from running import Program

STARTED = re.compile(r"process\[(\S+)-\d+\]: started with pid \[(\d+)\]")
POLL_S = 0.02
SUBSCRIBE_PERIOD_S = 0.5


@dataclass(frozen=True, slots=True)
class Outcome:
    """What followed from one kill: the time until the launch had ended or all was well again [s, wall], and faults."""

    what: str
    seconds: float
    faults: tuple[str, ...]

    def __str__(self) -> str:
        return "\n".join((f"{self.what}: {self.seconds:.1f} s", *(f"FAULT: {fault}" for fault in self.faults)))


class Processes:
    """The nodes of a launch by name, such as "/robot_0/controller", as roslaunch reports them."""

    def __init__(self, program: Program) -> None:
        self._program = program

    @property
    def pids(self) -> dict[str, int]:
        """The newest process of each node."""
        found = map(STARTED.search, list(self._program.lines))
        return {f"/{match[1]}": int(match[2]) for match in found if match}

    def wait_for(self, nodes: Sequence[str]) -> dict[str, int]:
        """Wait until roslaunch has started these nodes; return all processes."""
        for node in nodes:
            self._program.wait_for(lambda line, node=node: f"process[{node[1:]}-" in line, f"the start of {node}")
        return self.pids


def is_alive(pid: int) -> bool:
    """Whether a process is running, and not a zombie."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    return False


def peak_memory_mb(pid: int) -> float:
    """Return the largest memory that a running process has used; 0 if it has ended."""
    with contextlib.suppress(OSError):
        if match := re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text()):
            return int(match[1]) / 1024
    return 0.0


def wait_for(holds: Callable[[], bool], timeout_s: float) -> bool:
    """Wait until something holds, with a timeout [s, wall]; return whether it does."""
    until_s = time.monotonic() + timeout_s
    while not (result := holds()) and time.monotonic() < until_s:
        time.sleep(POLL_S)
    return result


class Watch:
    """Subscribes to all that some nodes publish; notes when each node published last, and passes messages on."""

    def __init__(self, nodes: Sequence[str], receive: Callable[[str, str, bytes], None] = lambda *_: None) -> None:
        """Args: receive: called with node, topic and bytes of each message, in threads of rospy."""
        self._nodes = frozenset(nodes)
        self._receive = receive
        self._last_s: dict[str, float] = {}
        self._subscribers: dict[str, rospy.Subscriber] = {}
        self._lock = threading.Lock()

    def subscribe(self) -> None:
        """Subscribe to what the nodes publish now."""
        published, _, _ = rosgraph.Master("/faults").getSystemState()
        for topic, publishers in published:
            if topic not in self._subscribers and self._nodes & {_node_of(name) for name in publishers}:
                self._subscribers[topic] = rospy.Subscriber(topic, rospy.AnyMsg, self._put, callback_args=topic)

    def wait_until_all_publish(self, since_s: float, timeout_s: float) -> dict[str, float]:
        """Wait until each node has published after a moment [s, monotonic]; return the delays, inf for the silent."""
        until_s = time.monotonic() + timeout_s
        while not wait_for(lambda: min(self._delays_s(since_s).values()) >= 0.0, SUBSCRIBE_PERIOD_S):
            self.subscribe()
            if time.monotonic() > until_s:
                break
        return {node: delay_s if delay_s >= 0.0 else float("inf") for node, delay_s in self._delays_s(since_s).items()}

    def close(self) -> None:
        """Unsubscribe."""
        for subscriber in self._subscribers.values():
            subscriber.unregister()

    def _delays_s(self, since_s: float) -> dict[str, float]:
        with self._lock:
            return {node: self._last_s.get(node, -1.0) - since_s for node in self._nodes}

    def _put(self, message: rospy.AnyMsg, topic: str) -> None:
        node = _node_of(message._connection_header["callerid"])
        if node in self._nodes:
            with self._lock:
                self._last_s[node] = time.monotonic()
            self._receive(node, topic, message._buff)


def _node_of(publisher: str) -> str:
    """Return the node of a publisher: the simulation publishes under a name of its own."""
    return publisher.removesuffix("_topics")
