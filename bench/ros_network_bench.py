"""Whether the network's topic keeps its pace in real time with many robots, and what each node costs for it.

Robots without controllers, at real time, in the garage; world, environment and mission run.
- `links`: one listener to /network/links, without matrices.
- `state`: one listener to /network/state, which has the matrices.

With --speed 0.2 the nodes have five times as long for each step, so that a busy machine leaves none out; what a node
costs per simulated second stays the same.

Printed: messages per second of wall time, steps left out, and the processor time of each node per simulated second. On
a busy machine the last is the reliable figure: each node needs less than 1 s.
Usage, with the build's devel/setup.sh sourced:
python bench/ros_network_bench.py [--topic links] [--robots 1000] [--seconds 30] [--speed 1] [--csv FILE]
"""

from __future__ import annotations

import argparse
import itertools
import os
import signal
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xmlrpc.client import ServerProxy

import results_file
import rosgraph
import rospy
from ros_processes import GRACE_S, ROSLAUNCH, busy_s, environment

NODES = ("simulation",)
STEP_S = 0.1
WARM_UP_STEPS = 50
START_TIMEOUT_S = 600.0
"""The nodes of 1000 robots register 17,000 topics at one master [s, wall]."""
STAMP = slice(4, 12)
"""Where a message that begins with a header carries its stamp: two unsigned 32-bit numbers, s and ns."""


class Listener:
    """Takes the stamps of a topic's messages, and leaves the rest of them unread."""

    def __init__(self, topic: str) -> None:
        self.arrivals: list[tuple[float, int]] = []
        rospy.Subscriber(topic, rospy.AnyMsg, self._put, tcp_nodelay=True)

    def _put(self, message: rospy.AnyMsg) -> None:
        stamp = message._buff[STAMP]
        stamp_ns = int.from_bytes(stamp[:4], "little") * 10**9 + int.from_bytes(stamp[4:], "little")
        self.arrivals.append((time.monotonic(), stamp_ns))


def pid_of(node: str) -> int:
    return ServerProxy(rosgraph.Master("/bench").lookupNode(f"/{node}")).getPid("/bench")[2]


@contextmanager
def launched(*arguments: str, speed: float = 1.0) -> Iterator[None]:
    """Launch the garage on a master of its own, as roslaunch would with these arguments; end it after."""
    with tempfile.TemporaryDirectory() as folder:
        port, env = environment(folder)
        os.environ |= env
        command = [*ROSLAUNCH, "-p", str(port)]
        command += [
            "robotteamsim",
            "scenario.launch",
            *arguments,
            f"speed:={speed:g}",
            "rviz:=false",
            "mission_stays:=true",
        ]
        launch = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            yield
        finally:
            launch.send_signal(signal.SIGINT)
            launch.wait(GRACE_S)


def measure(topic: str, robots: int, seconds: float, csv: Path | None) -> None:
    """Listen to a run that is under way, and print what was seen."""
    rospy.init_node("bench", disable_rostime=True, disable_signals=True)
    network = Listener(f"/network/{topic}")
    deadline_s = time.monotonic() + START_TIMEOUT_S
    while len(network.arrivals) < WARM_UP_STEPS:
        if time.monotonic() > deadline_s:
            raise SystemExit(f"/network/{topic}: {len(network.arrivals)} messages came within {START_TIMEOUT_S:.0f} s")
        time.sleep(0.1)
    pids = {name: pid_of(name) for name in NODES}
    first, before_s = len(network.arrivals), {name: busy_s(pid) for name, pid in pids.items()}
    time.sleep(seconds)
    used_s = {name: busy_s(pid) - before_s[name] for name, pid in pids.items()}
    arrivals = network.arrivals[first:]
    wall_s, sim_s = ((arrivals[-1][i] - arrivals[0][i]) * unit for i, unit in ((0, 1.0), (1, 1e-9)))
    gaps_s = [later[0] - earlier[0] for earlier, later in itertools.pairwise(arrivals)]
    rate_hz, left_out = len(gaps_s) / wall_s, round(sim_s / STEP_S) - len(gaps_s)
    costs = {f"{name} [s/s]": used / sim_s for name, used in used_s.items()}
    print(
        f"ros network, {topic} of {robots} robots: {rate_hz:.2f} Hz, {left_out} of {round(sim_s / STEP_S)} steps left "
        f"out, median {statistics.median(gaps_s) * 1e3:.0f} ms apart, at most {max(gaps_s) * 1e3:.0f} ms"
    )
    print("ros network, per simulated second: " + ", ".join(f"{name} {cost:.3f}" for name, cost in costs.items()))
    if csv:
        speed = {"speed": sim_s / wall_s, "rate [Hz]": rate_hz, "left out": left_out, "steps": len(gaps_s)}
        results_file.append(csv, f"network {topic}", robots, speed | costs)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--topic", choices=("links", "state"), default="links")
    parser.add_argument("--robots", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--speed", type=float, default=1.0, help="simulated over wall time")
    parser.add_argument("--csv", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    matrices = f"set:=network.publish_matrices={options.topic == 'state'}"
    with launched(f"robots:={options.robots}", "controllers:=false", matrices, speed=options.speed):
        measure(options.topic, options.robots, options.seconds, options.csv)


if __name__ == "__main__":
    main()
