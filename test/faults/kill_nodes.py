"""Kill each node of a mission by SIGKILL and SIGTERM at random moments, and check what follows.

ends:     the nodes are required, as in all launch files. The launch must end within 60 s and name the node, without
          a traceback, and the bag must be readable, or become so by `rosbag reindex`.
rejoins:  every node is started again when it has ended. All nodes must publish again within 60 s, no other node may
          end, and a robot whose controller is silent must brake after 0.8 s of simulated time.

Prints a line for each kill; the exit status is 1 if there were faults.
"""

from __future__ import annotations

import argparse
import random
import signal
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from ending import kill_and_see_the_end
from rejoining import Rejoining
from running import ROSLAUNCH, running
from sessions import CONTROLLERS, NODES, RECORDER, REJOINING, TEAM, master
from watching import Outcome

SIGNALS = (signal.SIGKILL, signal.SIGTERM)
ALL_NODES = (*NODES, *CONTROLLERS, TEAM, RECORDER)
SCENARIO = "garage_sar"

Case = tuple[str, signal.Signals]


def cases(options: argparse.Namespace, nodes: Sequence[str]) -> list[Case]:
    """Return each chosen node with each signal, as often as wanted, and all of them once before any a second time."""
    chosen = [node for node in options.nodes if node in nodes]
    return [(node, number) for _ in range(options.moments) for node in chosen for number in SIGNALS]


def run_ends(options: argparse.Namespace, port: int) -> Iterator[Outcome]:
    """Kill required nodes, one per launch."""
    generator = random.Random(options.seed)
    for node, number in cases(options, (*NODES, TEAM, RECORDER)):
        with tempfile.TemporaryDirectory() as folder:
            yield kill_and_see_the_end(node, number, generator, Path(folder), port)


def run_rejoins(options: argparse.Namespace, port: int) -> Iterator[Outcome]:
    """Kill nodes that are started again, all in two launches: a process per controller, and one for all of them."""
    generator = random.Random(options.seed)
    for hosted, controllers in (("nodes", CONTROLLERS), ("team", (TEAM,))):
        left = cases(options, (*NODES, *controllers) if hosted == "nodes" else controllers)
        while left:  # a launch with a fault is not used further
            command = (*ROSLAUNCH, REJOINING, f"controllers:={hosted}", f"scenario:={SCENARIO}")
            with tempfile.TemporaryDirectory() as folder, running(command, Path(folder), port) as program:
                launch = Rejoining(program, (*NODES, *controllers), SCENARIO)
                is_well = True
                while left and is_well:
                    yield (outcome := launch.kill(*left.pop(0), generator))
                    is_well = not outcome.faults
                launch.close()


MODES = {"ends": run_ends, "rejoins": run_rejoins}


def parsed(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nodes", nargs="*", metavar="NODE", help=f"default all: {' '.join(ALL_NODES)}")
    parser.add_argument("--mode", choices=[*MODES, "both"], default="both", help="(%(default)s)")
    parser.add_argument("--moments", type=int, default=10, metavar="N", help="per node and signal (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    options = parser.parse_args(arguments)
    options.nodes = options.nodes or list(ALL_NODES)
    unknown = [node for node in options.nodes if node not in ALL_NODES]
    if unknown:
        parser.error(f"no node {unknown[0]!r}; expected some of {' '.join(ALL_NODES)}")
    return options


def main(arguments: list[str]) -> int:
    options, num_faults = parsed(arguments), 0
    sys.setswitchinterval(1e-4)  # receiving threads of rospy must not slow each other down
    # One master for both: rospy stays with the one that it has begun with.
    with tempfile.TemporaryDirectory() as folder, master(Path(folder)) as port:
        for mode in MODES if options.mode == "both" else [options.mode]:
            for outcome in MODES[mode](options, port):
                print(f"{mode}: {outcome}", flush=True)
                num_faults += len(outcome.faults)
    print(f"{num_faults} faults")
    return 1 if num_faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
