"""A master for the nodes of a test."""

from __future__ import annotations

import contextlib
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from running import TIMEOUT_S, environment, wait_for_port


@contextlib.contextmanager
def master(folder: Path) -> Iterator[dict[str, str]]:
    """Run a master that this process uses, too; return the environment of other nodes."""
    variables = environment(folder)
    port = int(variables["ROS_MASTER_URI"].rpartition(":")[2])
    with pytest.MonkeyPatch.context() as patch:
        for name, value in variables.items():
            patch.setenv(name, value)
        with subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL) as process:
            wait_for_port(port)
            yield variables
            process.terminate()


def wait_until(holds: Callable[[], bool], what: str) -> None:
    deadline_s = time.monotonic() + TIMEOUT_S
    while not holds():
        assert time.monotonic() < deadline_s, f"{what} was waited for"
        time.sleep(0.01)
