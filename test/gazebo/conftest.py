"""Where Gazebo is: in the chroot that GAZEBO_CHROOT names, or on this machine."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
IN_CHROOT = ROOT / "setup" / "gazebo-chroot.sh"
PLUGINS = ROOT / "build" / "gazebo" / "devel" / "lib"
sys.path.append(str(ROOT / "test" / "ros"))


@pytest.fixture(scope="session")
def gazebo() -> tuple[str, ...]:
    """Return the arguments of scenario.launch that select Gazebo and its plugins."""
    chroot = os.environ.get("GAZEBO_CHROOT")
    world = ("world:=gazebo", "localization:=ground_truth")
    if not chroot:
        return world
    return *world, f"gzserver:={IN_CHROOT} run {chroot} gzserver", f"plugins:={PLUGINS}"


@pytest.fixture
def gzserver(monkeypatch: pytest.MonkeyPatch) -> tuple[str, ...]:
    """Return the command that runs Gazebo without its window; it finds the plugins, and models in no other place."""
    monkeypatch.setenv("GAZEBO_PLUGIN_PATH", str(PLUGINS))
    monkeypatch.setenv("GAZEBO_MODEL_DATABASE_URI", "")
    chroot = os.environ.get("GAZEBO_CHROOT")
    return (*((str(IN_CHROOT), "run", chroot) if chroot else ()), "gzserver")


@pytest.fixture(scope="session", autouse=True)
def _own_master_of_gazebo() -> None:
    """Give Gazebo's own transport a free port, because it refuses to share one."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        os.environ["GAZEBO_MASTER_URI"] = f"http://localhost:{probe.getsockname()[1]}"
    os.environ["GAZEBO_IP"] = "127.0.0.1"
