"""Kill a node of a running mission, which is started again: it rejoins, and its robots stop meanwhile."""

from __future__ import annotations

import os
import random
import signal
import struct
import threading
import time
from collections import defaultdict
from math import hypot

from running import Program
from watching import Outcome, Processes, Watch, wait_for

from robotteamsim.recording.bag_types import message_type
from robotteamsim.recording.topics.robots import read_odometry
from robotteamsim.scenario import load
from robotteamsim.setup import resolve

LATEST_S = 2.0
"""Nodes are killed up to this long after all nodes have worked [s, wall]."""
REJOIN_LIMIT_S = 60.0
STANDSTILL_MPS = 0.02
LATENESS_S = 1.0
"""On a busy machine the world gets an answer this much later than this process, or earlier [s, simulated]."""


class Motion:
    """The speeds of the robots, and the steps that their controllers have answered."""

    def __init__(self, scenario: str) -> None:
        self._lock = threading.Lock()
        self._speeds: defaultdict[str, list[tuple[float, float]]] = defaultdict(list)
        self._answers: defaultdict[str, list[float]] = defaultdict(list)
        settings = load(scenario)
        robot = resolve(settings).robots[0]
        braking_s = robot.drive.max_speed_mps / robot.drive.max_acceleration_mps2
        self._limit_s = robot.cmd_vel_hold_s + braking_s + 2 * settings.run.step_s + LATENESS_S
        """A command holds from its arrival, within the next step; then the robot brakes."""

    def receive(self, _: str, topic: str, data: bytes) -> None:
        """Note a message."""
        robot, _, name = topic[1:].partition("/")
        if name not in ("base_pose_ground_truth", "cmd_vel_stamped"):
            return
        secs, nanoseconds = struct.unpack_from("<II", data, 4)
        time_s = secs + 1e-9 * nanoseconds
        with self._lock:
            if name == "cmd_vel_stamped":
                # On a busy machine an answer comes late, and holds from its arrival.
                newest_s = self._speeds[robot][-1][0] if self._speeds[robot] else time_s
                self._answers[robot].append(max(time_s, newest_s))
            else:
                twist = read_odometry(message_type("nav_msgs/Odometry").decode(data)).twist
                self._speeds[robot].append((time_s, hypot(twist.linear_x_mps, twist.linear_y_mps)))

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._speeds.clear()
            self._answers.clear()

    def problems(self) -> tuple[list[str], float]:
        """Return where a robot drove without answers of its controller, and the longest drive without them [s]."""
        with self._lock:
            faults, longest_s = [], 0.0
            for robot, speeds in self._speeds.items():
                answers = sorted(self._answers[robot])
                moving = [time_s for time_s, speed_mps in speeds if speed_mps > STANDSTILL_MPS]
                waits_s = [time_s - max((a for a in answers if a <= time_s), default=time_s) for time_s in moving]
                longest_s = max([longest_s, *waits_s])
                if max(waits_s, default=0.0) > self._limit_s:
                    faults.append(f"{robot} drove {max(waits_s):.1f} s after the last answer of its controller")
            return faults, longest_s


class Rejoining:
    """A running launch whose nodes are killed one after another."""

    def __init__(self, program: Program, nodes: tuple[str, ...], scenario: str) -> None:
        """Wait until all nodes work."""
        self._program = program
        self._processes = Processes(program)
        self._processes.wait_for(nodes)
        self._motion = Motion(scenario)
        self._watch = Watch(nodes, self._motion.receive)
        assert not (silent := self._silent()), f"{silent} did not start\n{program.output}"

    def kill(self, node: str, number: signal.Signals, generator: random.Random) -> Outcome:
        """Kill a node at a random moment, and check that all goes on with the next process of it."""
        time.sleep(generator.uniform(0.0, LATEST_S))
        self._motion.clear()
        time.sleep(0.3)  # commands before the kill
        before, num_lines, killed_s = self._processes.pids, len(self._program.lines), time.monotonic()
        os.kill(before[node], number)
        is_started = wait_for(lambda: self._processes.pids[node] != before[node], REJOIN_LIMIT_S)
        faults = [f"{other} is silent" for other in self._silent()] if is_started else ["it was not started again"]
        seconds, after = time.monotonic() - killed_s, self._processes.pids
        faults += [f"{other} has ended, too" for other in after if other != node and after[other] != before[other]]
        output = "".join(self._program.lines[num_lines:])
        if "Traceback" in output:
            faults.append(f"a traceback was printed\n{output}")
        drives, longest_s = self._motion.problems() if node != "/simulation" else ([], 0.0)
        what = f"{node} {number.name}, longest drive without answers {longest_s:.1f} s"
        return Outcome(what, seconds, (*faults, *drives))

    def close(self) -> None:
        """Unsubscribe."""
        self._watch.close()

    def _silent(self) -> list[str]:
        delays_s = self._watch.wait_until_all_publish(time.monotonic(), REJOIN_LIMIT_S)
        return [node for node, delay_s in delays_s.items() if delay_s == float("inf")]
