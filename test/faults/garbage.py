"""Send garbage messages to every topic that the nodes of running missions subscribe to.

A message has the right type in its connection header, and then random bytes, a wrong length, NaN, infinities, huge and
subnormal numbers, wrong array sizes, odd texts, or a stamp in random order; some frames claim a wrong length. A fault
is a node that ends, prints a traceback, uses more than 1 GB, does not read for 5 s, or publishes nothing for 5 s after
a batch (--silence on a busy machine). Each launch gets an equal share of the messages; each goes to one subscriber.
"""

from __future__ import annotations

import argparse
import math
import os
import random
import re
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import genpy
import rosgraph
from garbage_bytes import GarbageMaker
from rich.console import Console
from running import ROSLAUNCH, Program, running
from sessions import MISSION, NODES, TEAM, master
from summary import print_table, progress_bar, write_csv
from tcpros import Connection, RawPublisher, Topic
from watching import Processes, Watch, is_alive, peak_memory_mb, wait_for

LAUNCHES = {
    "garage": ((MISSION, "set:=control.adaptation=fuzzy"), (*NODES, TEAM)),
    "office": (
        (MISSION, "scenario:=office_manet", "robots:=4"),
        (*NODES, TEAM),
    ),
    "warehouse": (
        (MISSION, "scenario:=warehouse_push", "robots:=3"),
        (*NODES, TEAM),
    ),
    "search": ((MISSION, "set:=control.algorithm=search"), (*NODES, TEAM)),
    "rescue": (
        (MISSION, "scenario:=garage_rescue", "robots:=-1"),
        (*NODES, TEAM),
    ),
    "fire": (
        (MISSION, "scenario:=office_fire", "robots:=-1"),
        (*NODES, TEAM),
    ),
    "lockstep": ((MISSION, "lockstep:=true"), (*NODES, TEAM)),
    "rescue in lockstep": (
        (MISSION, "scenario:=garage_rescue", "robots:=-1", "lockstep:=true"),
        (*NODES, TEAM),
    ),
    "world": (("robotteamsim", "world.launch", "robots:=3", "stage_requests:=true"), ("/simulation",)),
}
STOPPED = re.compile(r"is stopped: .*\.py:\d+\)")
BATCH = 2000
"""Messages between two checks of the nodes."""
WRONG_FRAMES = 1 / 1000
"""Share of frames that claim a wrong length."""
MEMORY_LIMIT_MB = 1024.0
START_TIMEOUT_S = 120.0
QUIET_TOPICS = ("/rosout", "/rosout_agg")


class Flood:
    """Sends garbage to the nodes of one launch and checks them."""

    def __init__(self, program: Program, nodes: tuple[str, ...], options: argparse.Namespace) -> None:
        self._program = program
        self._nodes = nodes
        self._random = random.Random(options.seed)
        self._rate_hz = options.rate
        self._silence_s = options.silence
        self._pids = Processes(program).wait_for(nodes)
        self._makers: dict[str, GarbageMaker] = {}
        self._watch = Watch(nodes, self._learn)
        self._publisher = RawPublisher("/garbage", os.environ["ROS_MASTER_URI"])
        self.faults: list[str] = []
        self.sent: Counter[str] = Counter()
        self.slowest = (0.0, "")
        """The longest time that a node needed to publish again after a batch [s, wall], and the node."""
        self.memory_mb: dict[str, float] = {}

    @property
    def num_topics(self) -> int:
        """Number of topics that get garbage."""
        return len(self._makers)

    def prepare(self) -> None:
        """Wait until all nodes work, and advertise what they subscribe to."""
        # Nodes publish once when they start, and then again when the mission runs.
        if self._all_publish() and self._all_publish():
            self._advertise()
            wait_for(lambda: {c.topic.name for c in self._connections()} >= self._makers.keys(), START_TIMEOUT_S)

    def _all_publish(self) -> bool:
        """Wait until all nodes publish; return whether they do."""
        start_s = time.monotonic()
        while max((delays_s := self._watch.wait_until_all_publish(start_s, 1.0)).values()) == math.inf:
            if self._program.process.poll() is not None or time.monotonic() > start_s + START_TIMEOUT_S:
                self.faults += [f"{node}: did not start" for node, delay_s in delays_s.items() if delay_s == math.inf]
                return False
        return True

    def send(self, count: int, advance: Callable[[int], object]) -> None:
        """Send messages in batches until all are sent or a node has failed."""
        while count > 0 and not self.faults:
            batch = min(BATCH, count)
            self._send_batch(batch)
            self._check()
            self._advertise()
            count -= batch
            advance(batch)

    def close(self) -> None:
        """Withdraw all topics."""
        self._publisher.close()
        self._watch.close()

    def _advertise(self) -> None:
        """Publish each topic that a node subscribes to now, and those without connections again."""
        connected = {connection.topic.name for connection in self._connections()}
        for topic in self._makers.keys() - connected:
            self._publisher.advertise_again(topic)
        master = rosgraph.Master("/faults")
        _, subscribed, _ = master.getSystemState()
        types = dict(master.getTopicTypes())
        for topic, subscribers in subscribed:
            message_class = genpy.message.get_message_class(types.get(topic, ""))
            is_ours = topic not in QUIET_TOPICS and bool(set(subscribers) & set(self._nodes))
            if is_ours and message_class is not None and topic not in self._makers:
                self._makers[topic] = GarbageMaker(message_class, self._random)
                self._publisher.advertise(Topic(topic, message_class._type, message_class._md5sum))

    def _send_batch(self, count: int) -> None:
        connections = self._connections()
        start_s = time.monotonic()
        for index in range(count):
            if index % 50 == 0:
                time.sleep(max(0.0, start_s + index / self._rate_hz - time.monotonic()))
                if not self._connections():
                    self._advertise()
                if not wait_for(lambda: bool(self._connections()), START_TIMEOUT_S):
                    self.faults.append("no node subscribes to anything")
                    return
                connections = self._connections()
            self._send(self._random.choice(connections))

    def _connections(self) -> list[Connection]:
        return [connection for connection in self._publisher.connections if connection.node in self._nodes]

    def _send(self, connection: Connection) -> None:
        data = self._makers[connection.topic.name].make()
        is_wrong = self._random.random() < WRONG_FRAMES
        claimed = self._random.choice((0, len(data) // 2, len(data) + 9, 10**6, 2**31, 2**32 - 1)) if is_wrong else None
        try:
            connection.send(data, claimed)
            self.sent[connection.node] += 1
        except TimeoutError:
            self.faults.append(f"{connection.node}: read nothing of {connection.topic.name} for 5 s; {data!r:.300}")
        except OSError:  # the node has closed it after a wrong frame
            is_wrong = True
        if is_wrong:
            self._publisher.drop(connection)

    def _check(self) -> None:
        ended = [node for node, pid in self._pids.items() if not is_alive(pid)]
        self.faults += [f"{node}: has ended" for node in ended]
        if "Traceback" in self._program.output:
            self.faults.append("a traceback was printed")
        if STOPPED.search(self._program.output):
            self.faults.append("a controller has raised an exception")
        if ended:
            return
        for node, pid in self._pids.items():
            self.memory_mb[node] = max(self.memory_mb.get(node, 0.0), peak_memory_mb(pid))
            if self.memory_mb[node] > MEMORY_LIMIT_MB:
                self.faults.append(f"{node}: {self.memory_mb[node]:.0f} MB")
        delays_s = self._watch.wait_until_all_publish(time.monotonic(), self._silence_s)
        self.slowest = max(self.slowest, *((delay_s, node) for node, delay_s in delays_s.items()))
        silent = [node for node, delay_s in delays_s.items() if delay_s > self._silence_s]
        self.faults += [f"{node}: silent for {self._silence_s:g} s" for node in silent]

    def _learn(self, _: str, topic: str, data: bytes) -> None:
        if topic in self._makers:
            self._makers[topic].learn(data)


def flood(
    name: str, options: argparse.Namespace, port: int, advance: Callable[[int], object]
) -> tuple[dict, list[str]]:
    """Run one launch with garbage; return a row of the summary, and the faults."""
    arguments, nodes = LAUNCHES[name]
    with tempfile.TemporaryDirectory() as folder, running((*ROSLAUNCH, *arguments), Path(folder), port) as program:
        sender = Flood(program, nodes, options)
        try:
            sender.prepare()
            sender.send(options.messages // len(options.launches), advance)
        finally:
            sender.close()
        if sender.faults:
            log = options.csv.parent / f"garbage-{name.split(',')[0]}.log"
            log.parent.mkdir(parents=True, exist_ok=True)
            log.write_text(program.output)
            sender.faults.append(f"the output is in {log}")
    row = {
        "launch": name,
        "nodes": len(nodes),
        "topics": sender.num_topics,
        "messages": sender.sent.total(),
        "peak memory [MB]": round(max(sender.memory_mb.values(), default=0.0)),
        "slowest [s]": round(sender.slowest[0], 2),
        "slowest node": sender.slowest[1],
        "faults": len(sender.faults),
    }
    return row, [f"{name}: {fault}" for fault in sender.faults]


def parsed(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("launches", nargs="*", metavar="LAUNCH", help=f"default all: {'; '.join(LAUNCHES)}")
    parser.add_argument("--messages", type=int, default=1_000_000, metavar="N", help="in all launches (%(default)s)")
    parser.add_argument("--rate", type=float, default=4000.0, metavar="HZ", help="messages per second (%(default)g)")
    parser.add_argument(
        "--silence", type=float, default=5.0, metavar="S", help="a longer silence is a fault (%(default)g)"
    )
    parser.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    parser.add_argument("--csv", type=Path, default=Path("build/faults/garbage.csv"), help="(%(default)s)")
    options = parser.parse_args(arguments)
    options.launches = options.launches or list(LAUNCHES)
    unknown = [name for name in options.launches if name not in LAUNCHES]
    if unknown:
        parser.error(f"no launch {unknown[0]!r}; expected one of: {'; '.join(LAUNCHES)}")
    return options


def main(arguments: list[str]) -> int:
    options, console = parsed(arguments), Console()
    # Otherwise each message would wait 5 ms for the threads that receive what the nodes publish.
    sys.setswitchinterval(1e-4)
    rows, faults = [], []
    with tempfile.TemporaryDirectory() as folder, master(Path(folder)) as port, progress_bar(console) as bar:
        task = bar.add_task("garbage", total=options.messages)
        for name in options.launches:
            bar.update(task, description=name)
            row, found = flood(name, options, port, lambda count: bar.advance(task, count))
            rows.append(row)
            faults += found
            write_csv(options.csv, rows)
    print_table(console, f"garbage messages, seed {options.seed}", rows)
    for fault in faults:
        console.print(fault, markup=False, highlight=False)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
