"""Kill a required node of a launch: the launch ends, names the node, and leaves a readable bag behind."""

from __future__ import annotations

import contextlib
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

from rosbags.rosbag1 import Reader
from rosbags.rosbag1.reader import ReaderError
from running import ROSLAUNCH, Program, running
from sessions import MISSION, RECORDER
from watching import Outcome, Processes

ROSBAG = (sys.executable, "-c", "import rosbag; rosbag.rosbagmain()")
OUR_CODE = re.compile(r'File "[^"]*/robotteamsim/[^"]*\.py"')
LATEST_S = 4.0
"""Nodes are killed up to this long after the start of the mission, or after their own, which takes two seconds or more
[s, wall]."""
END_LIMIT_S = 60.0
"""roslaunch waits up to 17 s for nodes that do not end; the rest is for a busy machine."""


def kill_and_see_the_end(
    node: str, number: signal.Signals, generator: random.Random, folder: Path, port: int
) -> Outcome:
    """Start a mission, kill a node at a random moment, and check what follows."""
    team, lockstep, starting = (generator.random() < share for share in (0.3, 0.5, 0.3))
    moment_s = generator.uniform(0.0, LATEST_S)
    arguments = (f"controllers:={'team' if team else 'nodes'}", f"lockstep:={lockstep}".lower())
    recorder = "rosbag" if node == RECORDER else "simulation"
    recording = ("record:=true", "bag:=run.bag", f"recorder:={recorder}")
    with running((*ROSLAUNCH, MISSION, *arguments, *recording), folder, port) as program:
        pid = Processes(program).wait_for([node])[node]
        if not starting:
            program.wait_for(lambda line: "mission starts" in line, "the start of the mission")
        time.sleep(moment_s)
        killed_s = time.monotonic()
        os.kill(pid, number)
        with contextlib.suppress(AssertionError):
            program.wait(END_LIMIT_S)
        seconds = time.monotonic() - killed_s
        has_ended = program.process.poll() is not None
    bag = bag_state(folder / "run.bag")
    faults = problems(program, node) + [f"the bag is {bag}"] * bag.startswith("unreadable")
    if not has_ended:
        faults.append(f"the launch did not end\n{program.output}")
    what = f"{node} {number.name} after {moment_s:.2f} s, {' '.join(arguments)}, bag {bag}"
    return Outcome(what, seconds, tuple(faults))


def problems(program: Program, node: str) -> list[str]:
    """Return what is wrong with the output of a launch whose node was killed."""
    faults = []
    if f"REQUIRED process [{node[1:]}-" not in program.output:
        faults.append(f"the launch does not name the node\n{program.output}")
    # SIGINT ends Python with a traceback until a node's first lines have set its handler; no package is imported then.
    if "Traceback" in program.output and OUR_CODE.search(program.output):
        faults.append(f"a traceback was printed\n{program.output}")
    return faults


def bag_state(path: Path) -> str:
    """Return "finished", "recovered" (by `rosbag reindex`), "none" (the recorder had not started), or "unreadable"."""
    active = path.with_name(f"{path.name}.active")
    if path.exists():
        return "finished" if is_readable(path) else "unreadable"
    if not active.exists() or active.stat().st_size == 0:
        return "none"
    result = subprocess.run((*ROSBAG, "reindex", "--quiet", str(active)), capture_output=True, text=True, check=False)
    if result.returncode == 0 and is_readable(active):
        return "recovered"
    return f"unreadable after rosbag reindex: {result.stdout}{result.stderr}"


def is_readable(path: Path) -> bool:
    """Whether all messages of a bag can be read."""
    with contextlib.suppress(ReaderError), Reader(path) as bag:
        for _ in bag.messages():
            pass
        return True
    return False
