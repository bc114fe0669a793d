"""Whether /network/state keeps its pace in real time with many robots, and what each node's process costs for it.

Robots without controllers, at real time; one listener for the state, and one per robot for its voice and its inbox.
Usage, with the build's devel/setup.sh sourced: python bench/ros_network_bench.py [--robots 100] [--seconds 30]
"""

from __future__ import annotations

import argparse
import itertools
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xmlrpc.client import ServerProxy

import rosgraph
import rospy

NODES = ("world", "environment", "mission")
STAMP = slice(4, 12)
"""Where a message that begins with a header carries its stamp: two unsigned 32-bit numbers, s and ns."""


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return probe.getsockname()[1]


class Listener:
    """Takes the stamps of a topic's messages, and leaves the rest of them unread."""

    def __init__(self, topic: str) -> None:
        self.arrivals: list[tuple[float, int]] = []
        rospy.Subscriber(topic, rospy.AnyMsg, self._put, tcp_nodelay=True)

    def _put(self, message: rospy.AnyMsg) -> None:
        stamp = message._buff[STAMP]
        stamp_ns = int.from_bytes(stamp[:4], "little") * 10**9 + int.from_bytes(stamp[4:], "little")
        self.arrivals.append((time.monotonic(), stamp_ns))


def cpu_s(pid: int) -> float:
    """Return the processor time that a process has used, in the system and outside [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def pid_of(node: str) -> int:
    return ServerProxy(rosgraph.Master("/bench").lookupNode(f"/{node}")).getPid("/bench")[2]


@contextmanager
def launched(*arguments: str) -> Iterator[None]:
    """Launch the garage at real time on a master of its own, as roslaunch would with these arguments; end it after."""
    with tempfile.TemporaryDirectory() as folder:
        port = free_port()
        os.environ |= {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOME": folder, "ROS_LOG_DIR": folder}
        command = [sys.executable, "-c", "import roslaunch; roslaunch.main()", "-p", str(port)]
        command += ["robotteamsim", "scenario.launch", *arguments, "speed:=1", "rviz:=false", "mission_stays:=true"]
        launch = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            yield
        finally:
            launch.send_signal(signal.SIGINT)
            launch.wait(30.0)


def measure(robots: int, seconds: float) -> None:
    """Listen to a run that is under way, and print what was seen."""
    rospy.init_node("bench", disable_rostime=True, disable_signals=True)
    network = Listener("/network/state")
    for i in range(robots):
        for name in ("voice", "network/rx"):
            rospy.Subscriber(f"/robot_{i}/{name}", rospy.AnyMsg, lambda _: None, tcp_nodelay=True)
    deadline_s = time.monotonic() + 120.0
    while len(network.arrivals) < 50:
        if time.monotonic() > deadline_s:
            raise SystemExit("/network/state: fewer than 50 messages came within two minutes")
        time.sleep(0.1)
    pids = {name: pid_of(name) for name in NODES}
    first, began_s = len(network.arrivals), time.monotonic()
    before_s = {name: cpu_s(pid) for name, pid in pids.items()}
    time.sleep(seconds)
    wall_s = time.monotonic() - began_s
    arrivals = network.arrivals[first:]
    shares = {name: (cpu_s(pid) - before_s[name]) / wall_s for name, pid in pids.items()}
    gaps_s = [later[0] - earlier[0] for earlier, later in itertools.pairwise(arrivals)]
    skipped = sum(later[1] - earlier[1] != 10**8 for earlier, later in itertools.pairwise(arrivals))
    print(
        f"ros network, {robots} robots: {len(arrivals) / wall_s:.2f} Hz, {skipped} steps skipped, "
        f"median {statistics.median(gaps_s) * 1e3:.0f} ms apart, at most {max(gaps_s) * 1e3:.0f} ms"
    )
    print("ros network, share of one core: " + ", ".join(f"{name} {share:.0%}" for name, share in shares.items()))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=30.0)
    options = parser.parse_args()
    with launched(f"robots:={options.robots}", "controllers:=false"):
        measure(options.robots, options.seconds)


if __name__ == "__main__":
    main()
