"""Each test has a ROS domain of its own, and leaves nothing in shared memory."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from peer import Peer

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["FASTDDS_BUILTIN_TRANSPORTS"] = "UDPv4"  # no shared memory, which a killed process would leave behind

DOMAINS = range(1, 100)

# Every Python imports a module of the name sitecustomize when it starts.
FAULT = """
import itertools
from {module} import {owner}
from rclpy.impl.implementation_singleton import rclpy_implementation

def failing(method):
    numbers = itertools.count(1)

    def call(publisher, message):
        # rclpy itself sends the events of parameters.
        if type(message).__name__ != "ParameterEvent" and next(numbers) % 3 == 0:
            raise rclpy_implementation.RCLError("Failed to publish: cannot publish data")
        method(publisher, message)

    return call

{owner}.{method} = failing({owner}.{method})
"""


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """The number of a domain that no other test on this machine uses."""
    for number in DOMAINS:
        with Path(tempfile.gettempdir(), f"robotteamsim-domain-{number}.lock").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
            yield number
            return
    raise AssertionError("all domains are in use")


@pytest.fixture
def peer(domain: int) -> Iterator[Peer]:
    """A node that is not ours."""
    found = Peer(domain)
    yield found
    found.close()


@pytest.fixture
def break_every_third(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str, str], None]:
    """Let every third call of a method of rclpy fail in programs that are started, as a publish of Kilted may."""

    def install(module: str, owner: str, method: str) -> None:
        (tmp_path / "sitecustomize.py").write_text(FAULT.format(module=module, owner=owner, method=method))
        monkeypatch.setenv("PYTHONPATH", str(tmp_path))

    return install


LOSS = """
import time
import warnings
from rclpy.service import Service

def losing(send):
    def call(service, response, header):
        if service.srv_name.endswith("/get_parameters"):
            call.number += 1
            print(f"answer {call.number} after {time.monotonic():.3f} s", flush=True)
            if call.number == 1:
                warnings.warn("failed to send response (timeout), at a.cpp:1, at a.c:1", RuntimeWarning)
                return
        send(service, response, header)

    call.number = 0
    return call

Service.send_response = losing(Service.send_response)
"""


@pytest.fixture
def lose_first_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let programs lose the first value of a parameter that they send, as if the client were not discovered yet."""
    (tmp_path / "sitecustomize.py").write_text(LOSS)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
