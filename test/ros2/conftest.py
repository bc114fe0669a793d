"""Each test has a ROS domain of its own, and leaves nothing in shared memory."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from peer import Peer

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["FASTDDS_BUILTIN_TRANSPORTS"] = "UDPv4"  # no shared memory, which a killed process would leave behind

DOMAINS = range(1, 100)


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
