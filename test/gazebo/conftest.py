"""Where Gazebo is: in the chroot that GAZEBO_CHROOT names, or on this machine."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "test" / "ros"))


@pytest.fixture(scope="session")
def gazebo() -> tuple[str, ...]:
    """Return the arguments of gazebo_garage.launch that select Gazebo and its plugins."""
    chroot = os.environ.get("GAZEBO_CHROOT")
    if not chroot:
        return ()
    program = f"{ROOT / 'setup' / 'gazebo-chroot.sh'} run {chroot} gzserver"
    return f"gzserver:={program}", f"plugins:={ROOT / 'build' / 'gazebo' / 'devel' / 'lib'}"


@pytest.fixture(scope="session", autouse=True)
def _own_master_of_gazebo() -> None:
    """Give Gazebo's own transport a free port, because it refuses to share one."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        os.environ["GAZEBO_MASTER_URI"] = f"http://localhost:{probe.getsockname()[1]}"
    os.environ["GAZEBO_IP"] = "127.0.0.1"
