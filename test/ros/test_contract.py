"""Runs check_contract.py in a process of its own: a process can be a node of rospy at only one master."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from running import TIMEOUT_S

CHECKS = Path(__file__).with_name("check_contract.py")


def test_world_behind_ros_keeps_the_contract_of_worlds() -> None:
    command = (sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist", str(CHECKS))
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=2.0 * TIMEOUT_S)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^12 passed in", done.stdout, re.MULTILINE), done.stdout
