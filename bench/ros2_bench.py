"""How fast missions run in ROS 2, and what the simulation's process costs per step, with one reader in another process.

Each case runs for some simulated time as fast as it can. Printed: simulated over wall time, the processor time of the
simulation per step, and the share of the reader's messages that came. Run by `make bench_ros2`, in build/venv-ros2.
"""

from __future__ import annotations

import argparse
import importlib
import multiprocessing
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import rclpy
import results_file
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.qos import HistoryPolicy, QoSProfile

STEPS = 600
CASES = {
    "everything": (3, ("--controllers", "inside"), r".*"),
    "lockstep, three controller processes": (3, ("--lockstep",), None),
    "scans, odometry, tf": (30, ("--controllers", "inside"), r"/tf|/robot_\d+/(base_scan|odom)"),
    "scans, odometry, tf of a hundred": (100, ("--controllers", "inside"), r"/tf|/robot_\d+/(base_scan|odom)"),
}
"""Number of robots, options of the mission, and the topics of the reader."""
TICKS = os.sysconf("SC_CLK_TCK")


def read(pattern: str | None, ready: Any, done: Any, counts: Any) -> None:
    """Subscribe to all topics of a mission that match, and count what comes until it is over."""
    rclpy.init()
    node, counted = rclpy.create_node("bench_reader"), [0]
    deadline_s = time.monotonic() + 60.0
    while not node.count_publishers("/clock") and time.monotonic() < deadline_s:
        time.sleep(0.1)
    time.sleep(3.0)  # discovery of all topics
    profile = QoSProfile(depth=0, history=HistoryPolicy.KEEP_ALL)

    def count(_: bytes) -> None:
        counted[0] += 1

    found = node.get_topic_names_and_types() if pattern else []
    topics = [(name, kind) for name, (kind, *_) in found if re.fullmatch(str(pattern), name)]
    for name, kind in topics:
        package, _, message = kind.split("/")
        message_class = getattr(importlib.import_module(f"{package}.msg"), message)
        node.create_subscription(message_class, name, count, profile, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)
    ready.set()
    while not done.is_set():
        executor.spin_once(timeout_sec=0.1)
    counts.put((len(topics), counted[0]))
    rclpy.shutdown()


def cpu_s(pid: int) -> float:
    """Return the processor time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def child_of(pid: int) -> int:
    """Return the id of the first process that a process has started."""
    return int(Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="utf-8").split()[0])


def measure(robots: int, options: tuple[str, ...], pattern: str | None) -> dict[str, float]:
    """Run one case; return its quantities by name and unit."""
    context = multiprocessing.get_context("spawn")
    ready, done, counts = context.Event(), context.Event(), context.Queue()
    reader = context.Process(target=read, args=(pattern, ready, done, counts))
    limit = f"mission.time_limit_s={STEPS / 10 + 1}"
    command = (sys.executable, "-m", "robotteamsim.ros2", "garage_sar", "--seed", "7", "--robots", str(robots))
    command += ("--set", limit, "--speed", "0", "--paused", "--stays", *options)
    with tempfile.TemporaryFile() as log, subprocess.Popen(command, stdout=log, stderr=log) as mission:
        reader.start()
        if not ready.wait(120.0):
            raise SystemExit("the reader did not start")
        rclpy.init()
        client_node = rclpy.create_node("bench")
        executor = SingleThreadedExecutor()
        executor.add_node(client_node)
        step_type = importlib.import_module("robotteamsim.srv").Step
        client = client_node.create_client(step_type, "/simulation/step")
        client.wait_for_service(60.0)

        def steps(number: int) -> None:
            executor.spin_until_future_complete(client.call_async(step_type.Request(steps=number)), 300.0)

        steps(20)  # warm-up
        simulation = child_of(mission.pid)
        begin_s, before_s = time.monotonic(), cpu_s(simulation)
        steps(STEPS)
        wall_s, used_s = time.monotonic() - begin_s, cpu_s(simulation) - before_s
        time.sleep(1.0)  # the last messages
        done.set()
        topics, counted = counts.get(timeout=60.0)
        reader.join(30.0)
        mission.terminate()
        rclpy.shutdown()
    return {
        "speed [s/s]": STEPS * 0.1 / wall_s,
        "simulation's processor time [ms/step]": 1e3 * used_s / STEPS,
        "topics": topics,
        "messages": counted / (STEPS + 20),
    }


def main() -> None:
    """Measure all cases, and print and write them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csv", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for name, (robots, arguments, pattern) in CASES.items():
        quantities = measure(robots, arguments, pattern)
        print(f"ros 2, {name}, {robots} robots:", ", ".join(f"{key} {value:.3g}" for key, value in quantities.items()))
        if options.csv:
            results_file.append(options.csv, name, robots, quantities)


if __name__ == "__main__":
    main()
