"""The clock that Gazebo follows in `gazebo_missions.py`: a node that begins each step when the last one is decided.

`world:=gazebo` alone does not wait for decisions, so on a busy machine they would come late. At the mission's end it
writes a JSON object into the file of its argument: how fast the mission ran, and processor time per simulated second.
"""

from __future__ import annotations

import contextlib
import json
import sys
import threading
import time
import xmlrpc.client
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rosgraph
import rospy
from robotteamsim.msg import MissionStatus
from rosgraph_msgs.msg import Clock

from bench.ros_processes import busy_s
from robotteamsim.scenario import load

START_S, CHECK_S = 300.0, 0.1
"""Gazebo and the simulation connect within this time; waits are checked at this interval [s, wall]."""
SILENCE_S = 300.0
"""A mission that makes no step for so long has failed [s, wall]."""
NODES = ("gazebo", "simulation")
ROBOT_TOPICS = ("cmd_vel", "odom", "base_scan", "base_pose_ground_truth", "contact")
"""Gazebo's, of each robot."""


@dataclass(frozen=True)
class Moment:
    """Time of the mission, on the wall, and of the processor in each node [s]."""

    sim_s: float
    wall_s: float
    busy_s: dict[str, float]


class MissionClock:
    """Publishes /clock, a step ahead of the last decision."""

    def __init__(self, step_s: float) -> None:
        """Args: step_s: of the mission [s]."""
        self._step = rospy.Duration(step_s)
        self._now = rospy.Time()
        self._first: Moment | None = None
        self._last: Moment | None = None
        self._heard_s = time.monotonic()
        self._ended = threading.Event()
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10, tcp_nodelay=True, latch=True)
        # The decisions of a step are published before its status.
        self._status = rospy.Subscriber("/mission/status", MissionStatus, self._put, tcp_nodelay=True)

    def run(self) -> dict[str, float]:
        """Publish until the mission has ended; return its speed and processor times [s/s]."""
        self._advance(self._now)
        while not self._ended.wait(CHECK_S):
            if rospy.is_shutdown():
                raise SystemExit("ended before the mission")
            if time.monotonic() - self._heard_s > SILENCE_S:
                raise RuntimeError(f"no step for {SILENCE_S:g} s, wall, after {self._now.to_sec():.1f} s")
        assert self._first is not None
        assert self._last is not None
        sim_s = self._last.sim_s - self._first.sim_s
        busy = {f"{name}_busy": (self._last.busy_s[name] - self._first.busy_s[name]) / sim_s for name in NODES}
        return {"speed": sim_s / (self._last.wall_s - self._first.wall_s), **busy}

    def _put(self, status: MissionStatus) -> None:
        if status.header.stamp == rospy.Time():
            return  # before the first step
        if self._first is None:
            self._pids = {name: _ask(name, "getPid") for name in NODES}
            self._first = self._moment(status)
        if status.state == "ended":
            self._last = self._moment(status)
            self._ended.set()
        self._heard_s = time.monotonic()
        self._advance(status.header.stamp)

    def _advance(self, decided: rospy.Time) -> None:
        self._now = max(self._now, decided + self._step)
        self._clock.publish(self._now)

    def _moment(self, status: MissionStatus) -> Moment:
        busy = {name: busy_s(pid) for name, pid in self._pids.items()}
        return Moment(status.header.stamp.to_sec(), time.monotonic(), busy)


def _ask(name: str, method: str) -> Any:
    """Return the answer of a node. Raises: OSError, rosgraph.MasterException: it is not there yet."""
    node = xmlrpc.client.ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(f"/{name}"))
    return getattr(node, method)(rospy.get_name())[2]


def wait_for_connections(num_robots: int) -> None:
    """Wait until the topics of Gazebo's robots are connected: a robot without one would stand still for good."""
    missing = wanted = {f"/robot_{robot_id}/{name}" for robot_id in range(num_robots) for name in ROBOT_TOPICS}
    deadline_s = time.monotonic() + START_S
    while missing:
        if time.monotonic() > deadline_s:
            raise RuntimeError(f"not connected after {START_S:g} s, wall: {', '.join(sorted(missing))}")
        rospy.rostime.wallsleep(CHECK_S)
        with contextlib.suppress(OSError, rosgraph.MasterException):
            missing = wanted - {link[4] for link in _ask("gazebo", "getBusInfo")}


def main() -> None:
    """Be the clock of a mission."""
    rospy.init_node("mission_clock", disable_rostime=True)
    scenario = load("garage_sar")
    clock = MissionClock(scenario.run.step_s)
    wait_for_connections(scenario.num_robots)
    Path(sys.argv[1]).write_text(json.dumps(clock.run()))


if __name__ == "__main__":
    main()
