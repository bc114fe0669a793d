"""Starting ROS programs for tests: each with a master, a home and a log of its own, all of it ended afterwards."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

TIMEOUT_S = 300.0
"""A busy machine may take this long for what takes seconds [s, wall]."""
GRACE_S = 30.0

ROSTEST = (sys.executable, "-c", "import rostest; rostest.rostestmain()")
ROSCORE = (sys.executable, "-c", "import sys, roslaunch; roslaunch.main(['roscore', '--core', *sys.argv[1:]])")
ROSLAUNCH = (sys.executable, "-c", "import roslaunch; roslaunch.main()")


def environment(folder: Path, port: int | None = None) -> dict[str, str]:
    """Return an environment in which programs write only into the folder and open no window.

    Args: port: of a ROS master that is running; None: a free one, for a master of its own.
    """
    inherited = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    return inherited | {
        "PWD": str(folder),
        # Otherwise roslaunch and nodes keep their output back until a pipe's buffer is full.
        "PYTHONUNBUFFERED": "1",
        "ROS_HOME": str(folder / "home"),
        "ROS_LOG_DIR": str(folder / "log"),
        "ROS_TEST_RESULTS_DIR": str(folder / "results"),
        "ROS_MASTER_URI": f"http://localhost:{port or free_port()}",
        "ROS_HOSTNAME": "localhost",
        "ROSTEST_PYTHON": sys.executable,
        "ROSTEST_OUT": str(folder / "out"),
    }


def free_port() -> int:
    """Return a port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


def reserved_port() -> socket.socket:
    """Return a socket that keeps a free port for a server of ROS that is started later."""
    reservation = socket.socket()
    # Two sockets with this option, which servers of ROS have, can share a port, if both asked for its number.
    reservation.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    reservation.bind(("localhost", 0))
    return reservation


def wait_for_port(port: int) -> None:
    """Wait until somebody listens on a port."""
    deadline_s = time.monotonic() + TIMEOUT_S
    while time.monotonic() < deadline_s:
        with socket.socket() as caller:
            if caller.connect_ex(("localhost", port)) == 0:
                return
        time.sleep(0.05)
    raise AssertionError(f"nobody listens on port {port}")


class Program:
    """A program that runs, and the lines that it has written so far."""

    def __init__(self, command: Sequence[str], folder: Path, port: int | None = None) -> None:
        self._reservation = reserved_port()
        self.port = port or self._reservation.getsockname()[1]
        if command[: len(ROSLAUNCH)] in (ROSLAUNCH, ROSCORE):
            command = (*command[: len(ROSLAUNCH)], "-p", str(self.port), *command[len(ROSLAUNCH) :])
        self.process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment(folder, self.port),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
        )
        self.lines: list[str] = []
        self._changed = threading.Condition()
        self._ended = False
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    @property
    def output(self) -> str:
        """All that it has written so far."""
        return "".join(self.lines)

    def wait_for(self, holds: Callable[[str], bool], what: str) -> str:
        """Wait for a line of which something holds, and return it."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or any(map(holds, self.lines)), timeout=TIMEOUT_S)
            for line in self.lines:
                if holds(line):
                    return line
        raise AssertionError(f"no line with {what} came:\n{self.output}")

    def wait(self, timeout_s: float = TIMEOUT_S) -> int:
        """Wait until it has ended by itself, and return its exit status."""
        try:
            status = self.process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"still running after {timeout_s:g} s:\n{self.output}") from None
        self._reader.join(GRACE_S)
        return status

    def stop(self) -> None:
        """End it, and whatever it has started."""
        started = descendants(self.process.pid)
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.process.wait(GRACE_S)
        for pid in (self.process.pid, *started):
            if pid != self.process.pid or self.process.poll() is None:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
        self.process.wait(GRACE_S)
        self._reservation.close()
        self._reader.join(GRACE_S)
        assert self.process.stdout is not None
        self.process.stdout.close()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            with self._changed:
                self.lines.append(line)
                self._changed.notify_all()
        with self._changed:
            self._ended = True
            self._changed.notify_all()


@contextlib.contextmanager
def running(command: Sequence[str], folder: Path, port: int | None = None) -> Iterator[Program]:
    """Run a program, at a running master or its own; in the end it and whatever it has started are gone."""
    program = Program(command, folder, port)
    try:
        yield program
    finally:
        program.stop()


def descendants(pid: int) -> list[int]:
    """Return the ids of all processes that a process has started, and those have started, and so on."""
    parents: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            fields = stat.read_text().rpartition(")")[2].split()
            parents.setdefault(int(fields[1]), []).append(int(stat.parent.name))
    found, open_ids = [], [pid]
    while open_ids:
        children = parents.get(open_ids.pop(), [])
        found += children
        open_ids += children
    return found
