"""The tools of test/faults with a few kills and messages: `make faults` and `make garbage` take hours."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
TIMEOUT_S = 900.0


def run_tool(name: str, *arguments: str) -> None:
    path = os.pathsep.join((str(TESTS / "ros"), str(TESTS / "fuzz"), os.environ["PYTHONPATH"]))
    command = (sys.executable, str(TESTS / "faults" / f"{name}.py"), *arguments)
    environment = os.environ | {"PYTHONPATH": path}
    result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=TIMEOUT_S, env=environment)
    assert result.returncode == 0, result.stdout + result.stderr


def rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def test_launch_ends_with_a_readable_bag_when_a_node_is_killed(tmp_path):
    run_tool("kill_nodes", "--mode=ends", "--moments=1", f"--csv={tmp_path / 'k.csv'}", "/simulation", "/recorder")
    found = rows(tmp_path / "k-ends.csv")
    assert [(row["node"], row["signal"]) for row in found] == [
        ("/recorder", "SIGKILL"),
        ("/recorder", "SIGTERM"),
        ("/simulation", "SIGKILL"),
        ("/simulation", "SIGTERM"),
    ]
    assert {(row["moments"], row["faults"]) for row in found} == {("1", "0")}


def test_node_that_is_killed_and_started_again_rejoins_and_its_robot_stops_meanwhile(tmp_path):
    run_tool("kill_nodes", "--mode=rejoins", "--moments=1", f"--csv={tmp_path / 'k.csv'}", "/robot_0/controller")
    assert {(row["signal"], row["faults"]) for row in rows(tmp_path / "k-rejoins.csv")} == {
        ("SIGKILL", "0"),
        ("SIGTERM", "0"),
    }


@pytest.mark.parametrize("launch", ["garage", "lockstep", "world"])
def test_garbage_messages_end_and_hang_no_node(tmp_path, launch):
    run_tool("garbage", "--messages=4000", "--silence=60", f"--csv={tmp_path / 'g.csv'}", launch)
    (row,) = rows(tmp_path / "g.csv")
    assert int(row["messages"]) > 3500  # some connections end with frames that claim a wrong length
    assert row["faults"] == "0"


def test_tools_explain_themselves_and_reject_unknown_names():
    for name in ("kill_nodes", "garbage"):
        run_tool(name, "--help")
        with pytest.raises(AssertionError, match=r"expected (some|one) of"):
            run_tool(name, "nothing")
