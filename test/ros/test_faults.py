"""The tools of test/faults with a few kills and messages: `make faults` and `make garbage` take hours."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
TIMEOUT_S = 900.0


def run_tool(name: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join((str(TESTS / "ros"), str(TESTS / "fuzz"), os.environ["PYTHONPATH"]))
    command = (sys.executable, str(TESTS / "faults" / f"{name}.py"), *arguments)
    environment = os.environ | {"PYTHONPATH": path}
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIMEOUT_S, env=environment)


def output_of(name: str, *arguments: str) -> str:
    """Return what a tool prints; it must find no faults."""
    result = run_tool(name, *arguments)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.mark.parametrize(
    ("mode", "nodes"), [("ends", ("/simulation", "/recorder")), ("rejoins", ("/robot_0/controller",))]
)
def test_launch_ends_with_a_readable_bag_or_goes_on_when_a_node_is_killed(mode, nodes):
    output = output_of("kill_nodes", f"--mode={mode}", "--moments=1", *nodes)
    kills = re.findall(rf"^{mode}: (\S+) (SIG\w+)", output, re.MULTILINE)
    assert sorted(kills) == sorted((node, number) for node in nodes for number in ("SIGKILL", "SIGTERM"))
    assert output.endswith("\n0 faults\n")


@pytest.mark.parametrize("launch", ["garage", "lockstep", "world"])
def test_garbage_messages_end_and_hang_no_node(launch):
    output = output_of("garbage", "--messages=4000", "--silence=60", launch)
    assert output.startswith(f"{launch}: 4000 messages on ")
    assert output.endswith("\n0 faults\n")


@pytest.mark.parametrize(("name", "what"), [("kill_nodes", "node"), ("garbage", "launch")])
def test_tool_rejects_an_unknown_name(name, what):
    result = run_tool(name, "nothing")
    assert result.returncode == 2
    assert re.search(rf"error: no {what} 'nothing'; expected (some|one) of", result.stderr)
