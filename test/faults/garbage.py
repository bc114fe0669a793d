"""Send garbage messages to every topic that the nodes of running missions subscribe to.

A message has the right type in its connection header, and then random bytes, a wrong length, NaN, infinities, huge and
subnormal numbers, wrong array sizes, odd texts, or a stamp in random order. A fault is a node that ends, prints a
traceback, uses more than 1 GB, or publishes nothing for 5 s after a batch (--silence on a busy machine). Each launch
gets an equal share of the messages. Prints a line for each launch; the exit status is 1 if there were faults.
"""

from __future__ import annotations

import argparse
import math
import random
import re
import sys
import tempfile
import time
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import genpy
import rosgraph
import rospy
from garbage_bytes import GarbageMaker
from running import ROSLAUNCH, Program, running
from sessions import MISSION, NODES, TEAM, master
from std_msgs.msg import Header
from watching import Processes, Watch, is_alive, peak_memory_mb, wait_for

OF_MISSION = (*NODES, TEAM)
# An odd stamp can take an input of a step away: then the simulation goes on after this time [s, wall].
LOCKSTEP = ("lockstep:=true", "silence_limit_s:=2")
LAUNCHES = {
    "garage": ((MISSION, "set:=control.adaptation=fuzzy"), OF_MISSION),
    "office": ((MISSION, "scenario:=office_manet", "robots:=4"), OF_MISSION),
    "warehouse": ((MISSION, "scenario:=warehouse_push", "robots:=3"), OF_MISSION),
    "search": ((MISSION, "set:=control.algorithm=search"), OF_MISSION),
    "rescue": ((MISSION, "scenario:=garage_rescue", "robots:=-1"), OF_MISSION),
    "fire": ((MISSION, "scenario:=office_fire", "robots:=-1"), OF_MISSION),
    "lockstep": ((MISSION, *LOCKSTEP), OF_MISSION),
    "rescue in lockstep": ((MISSION, "scenario:=garage_rescue", "robots:=-1", *LOCKSTEP), OF_MISSION),
    "world": (("robotteamsim", "world.launch", "robots:=3", "stage_requests:=true"), ("/simulation",)),
}
STOPPED = re.compile(r"is stopped: .*\.py:\d+\)")
BATCH = 2000
"""Messages between two checks of the nodes."""
MEMORY_LIMIT_MB = 1024.0
START_TIMEOUT_S = 120.0
TRIES = 4
"""How often a topic is published until a node connects to it, within the timeout."""
QUIET_TOPICS = ("/rosout", "/rosout_agg")


@cache
def raw_class(message_class: Any) -> Any:
    """Return a class of messages of a type whose bytes are arbitrary."""

    class Raw(message_class):  # type: ignore[misc]
        def __init__(self, data: bytes) -> None:
            self.data = data
            self.header = Header()

        def serialize(self, buff: BytesIO) -> None:
            buff.write(self.data)

    return Raw


class Flood:
    """Sends garbage to the nodes of one launch and checks them."""

    def __init__(self, program: Program, nodes: tuple[str, ...], options: argparse.Namespace) -> None:
        """Wait until all nodes work."""
        self._program = program
        self._nodes = nodes
        self._random = random.Random(options.seed)
        self._rate_hz = options.rate
        self._silence_s = options.silence
        self._pids = Processes(program).wait_for(nodes)
        self._makers: dict[str, GarbageMaker] = {}
        self._publishers: dict[str, rospy.Publisher] = {}
        self._watch = Watch(nodes, self._learn)
        self.faults: list[str] = []
        self.sent = 0
        self.slowest = (0.0, "")
        """The longest time that a node needed to publish again after a batch [s, wall], and the node."""
        self.memory_mb = 0.0
        for _ in range(2):  # nodes publish once when they start, and then again when the mission runs
            self._expect_messages(START_TIMEOUT_S)

    @property
    def num_topics(self) -> int:
        """Number of topics that get garbage."""
        return len(self._publishers)

    def send(self, count: int) -> None:
        """Send messages in batches until all are sent or a node has failed."""
        while self.sent < count and not self.faults:
            self._advertise()
            for index in range(min(BATCH, count - self.sent)):
                if index % 50 == 0:
                    time.sleep(50 / self._rate_hz)
                topic = self._random.choice(list(self._publishers))
                publisher = self._publishers[topic]
                publisher.publish(raw_class(publisher.data_class)(self._makers[topic].make()))
                self.sent += 1
            self._check()
        if "ignoring messages that cannot be read" not in self._program.output:
            self.faults.append("nothing was reported")

    def close(self) -> None:
        """Withdraw all topics."""
        for publisher in self._publishers.values():
            publisher.unregister()
        self._watch.close()

    def _advertise(self) -> None:
        """Publish each topic that a node subscribes to now, and wait until it has connected.

        Publish it again if nobody connects: rospy ends the connection after a message that it cannot read, and gives up
        connecting to a topic that is being withdrawn.
        """
        lost = self._unconnected()
        master = rosgraph.Master("/faults")
        _, subscribed, _ = master.getSystemState()
        types = dict(master.getTopicTypes())
        for topic, subscribers in subscribed:
            message_class = genpy.message.get_message_class(types.get(topic, ""))
            is_ours = topic not in QUIET_TOPICS and bool(set(subscribers) & set(self._nodes))
            if is_ours and message_class is not None and topic not in self._publishers:
                self._makers[topic] = GarbageMaker(message_class, self._random)
                self._publishers[topic] = rospy.Publisher(topic, message_class, queue_size=BATCH)
        for _ in range(TRIES):
            for topic in lost:
                message_class = self._publishers[topic].data_class
                self._publishers[topic].unregister()
                self._publishers[topic] = rospy.Publisher(topic, message_class, queue_size=BATCH)
            if wait_for(lambda: not self._unconnected(), START_TIMEOUT_S / TRIES):
                return
            lost = self._unconnected()
        self.faults.append(f"nobody subscribes to {', '.join(lost)}")

    def _unconnected(self) -> list[str]:
        return [topic for topic, publisher in self._publishers.items() if not publisher.get_num_connections()]

    def _check(self) -> None:
        for node, pid in self._pids.items():
            if not is_alive(pid):
                self.faults.append(f"{node}: has ended")
                return
            self.memory_mb = max(self.memory_mb, memory_mb := peak_memory_mb(pid))
            if memory_mb > MEMORY_LIMIT_MB:
                self.faults.append(f"{node}: {memory_mb:.0f} MB")
        if "Traceback" in self._program.output:
            self.faults.append("a traceback was printed")
        if STOPPED.search(self._program.output):
            self.faults.append("a controller has raised an exception")
        delays_s = self._expect_messages(self._silence_s)
        self.slowest = max(self.slowest, *((delay_s, node) for node, delay_s in delays_s.items()))

    def _expect_messages(self, timeout_s: float) -> dict[str, float]:
        """Wait until all nodes publish; return the delays [s, wall]."""
        delays_s = self._watch.wait_until_all_publish(time.monotonic(), timeout_s)
        self.faults += [f"{node}: silent for {timeout_s:g} s" for node, s in delays_s.items() if s == math.inf]
        return delays_s

    def _learn(self, _: str, topic: str, data: bytes) -> None:
        if topic in self._makers:
            self._makers[topic].learn(data)


def flood(name: str, options: argparse.Namespace, port: int) -> list[str]:
    """Run one launch with garbage, and print a line about it; return the faults."""
    arguments, nodes = LAUNCHES[name]
    with tempfile.TemporaryDirectory() as folder, running((*ROSLAUNCH, *arguments), Path(folder), port) as program:
        sender = Flood(program, nodes, options)
        sender.send(options.messages // len(options.launches))
        sender.close()
    slowest_s, slowest = sender.slowest
    print(
        f"{name}: {sender.sent} messages on {sender.num_topics} topics, peak {sender.memory_mb:.0f} MB, "
        f"slowest {slowest} {slowest_s:.2f} s",
        *(f"FAULT: {fault}" for fault in sender.faults),
        *([program.output] if sender.faults else []),
        sep="\n",
        flush=True,
    )
    return sender.faults


def parsed(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("launches", nargs="*", metavar="LAUNCH", help=f"default all: {'; '.join(LAUNCHES)}")
    parser.add_argument("--messages", type=int, default=1_000_000, metavar="N", help="in all launches (%(default)s)")
    parser.add_argument("--rate", type=float, default=4000.0, metavar="HZ", help="messages per second (%(default)g)")
    parser.add_argument(
        "--silence", type=float, default=5.0, metavar="S", help="a longer silence is a fault (%(default)g)"
    )
    parser.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    options = parser.parse_args(arguments)
    options.launches = options.launches or list(LAUNCHES)
    unknown = [name for name in options.launches if name not in LAUNCHES]
    if unknown:
        parser.error(f"no launch {unknown[0]!r}; expected one of: {'; '.join(LAUNCHES)}")
    return options


def main(arguments: list[str]) -> int:
    options = parsed(arguments)
    # Otherwise each message would wait 5 ms for the threads that receive what the nodes publish.
    sys.setswitchinterval(1e-4)
    with tempfile.TemporaryDirectory() as folder, master(Path(folder)) as port:
        faults = [fault for name in options.launches for fault in flood(name, options, port)]
    print(f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
