"""How fast missions run in ROS, and what the simulation's process costs per step, with one reader in another process.

Each case runs for some simulated time as fast as it can. Printed: simulated over wall time, the processor time of the
simulation per step, and the number of the reader's topics and messages per step. `make bench_ros2` runs it in ROS 1,
and in build/venv-jazzy (with ROS2=kilted, build/venv-kilted) in ROS 2: the version of ROS that is sourced.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import os
import tempfile
import time
from pathlib import Path
from typing import Any

import results_file
from ros_processes import busy_s

VERSION = 2 if os.environ.get("ROS_VERSION") == "2" else 1

if VERSION == 2:
    import peer_ros2 as peer
else:
    import peer_ros1 as peer

STEPS, WARM_UP_STEPS = 600, 20
CASES = {
    "everything": (3, {"controllers": "inside"}, r".*"),
    "lockstep, three controller processes": (3, {"controllers": "nodes", "lockstep": True}, None),
    "scans, odometry, tf": (30, {"controllers": "inside"}, r"/tf|/robot_\d+/(base_scan|odom)"),
    "scans, odometry, tf of a hundred": (100, {"controllers": "inside"}, r"/tf|/robot_\d+/(base_scan|odom)"),
}
"""Number of robots, settings of the mission, and the topics of the reader."""


def read(pattern: str | None, ready: Any, done: Any, counts: Any) -> None:
    """Receive the topics of a mission that match, and count what comes until it is over."""
    counted = [0]

    def count(_: object) -> None:
        counted[0] += 1

    counts.put((peer.receive(pattern, count, ready, done), counted[0]))


def measure(robots: int, settings: dict[str, Any], pattern: str | None) -> dict[str, float]:
    """Run one case; return its quantities by name and unit."""
    context = multiprocessing.get_context("spawn")
    ready, done, counts = context.Event(), context.Event(), context.Queue()
    reader = context.Process(target=read, args=(pattern, ready, done, counts))
    values = {"seed": 7, "robots": robots, "set": f"mission.time_limit_s={STEPS / 10 + 1}", **settings}
    with tempfile.TemporaryFile() as log, contextlib.ExitStack() as stack:
        mission = stack.enter_context(peer.paused_mission(values, log))
        reader.start()
        if not ready.wait(120.0):
            raise SystemExit("the reader did not start")
        mission.step(WARM_UP_STEPS)
        begin_s, before_s = time.monotonic(), busy_s(mission.pid)
        mission.step(STEPS)
        wall_s, used_s = time.monotonic() - begin_s, busy_s(mission.pid) - before_s
        time.sleep(1.0)  # the last messages
        done.set()
        topics, counted = counts.get(timeout=60.0)
        reader.join(30.0)
    return {
        "speed [s/s]": STEPS * 0.1 / wall_s,
        "simulation's processor time [ms/step]": 1e3 * used_s / STEPS,
        "topics": topics,
        "messages": counted / (STEPS + WARM_UP_STEPS),
    }


def main() -> None:
    """Measure all cases, and print and write them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with peer.network():
        for name, (robots, settings, pattern) in CASES.items():
            quantities = measure(robots, settings, pattern)
            shown = ", ".join(f"{key} {value:.3g}" for key, value in quantities.items())
            print(f"ROS {VERSION}, {name}, {robots} robots: {shown}", flush=True)
            if options.csv:
                results_file.append(options.csv, f"{name}, ROS {VERSION}", robots, quantities)


if __name__ == "__main__":
    main()
