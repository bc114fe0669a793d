"""Kill each node of a mission by SIGKILL and SIGTERM at random moments, and check what follows.

ends:     the nodes are required, as in all launch files. The launch must end within 60 s and name the node, without
          a traceback, and the bag must be readable, or become so by `rosbag reindex`.
rejoins:  every node is started again when it has ended. All nodes must publish again within 60 s, no other node may
          end, and a robot whose controller is silent must brake after 0.8 s of simulated time.
"""

from __future__ import annotations

import argparse
import random
import signal
import statistics
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from ending import Outcome, kill_and_see_the_end
from rejoining import Rejoining
from rich.console import Console
from running import ROSLAUNCH, running
from sessions import CONTROLLERS, NODES, REJOINING, TEAM, master
from summary import print_table, progress_bar, write_csv

SIGNALS = (signal.SIGKILL, signal.SIGTERM)
RECORDER = "/recorder"
ALL_NODES = (*NODES, *CONTROLLERS, TEAM, RECORDER)
SCENARIO = "garage_sar"

Case = tuple[str, signal.Signals]


class Results:
    """The outcomes of the kills of each node by each signal; written to the CSV file after each of them."""

    def __init__(self, mode: str, options: argparse.Namespace) -> None:
        self._mode = mode
        self._options = options
        self._outcomes: dict[Case, list[Outcome]] = {}

    def add(self, case: Case, outcome: Outcome) -> None:
        """Add an outcome."""
        self._outcomes.setdefault(case, []).append(outcome)
        write_csv(self._options.csv.with_stem(f"{self._options.csv.stem}-{self._mode}"), self.rows)
        if outcome.faults:
            log = self._options.csv.with_name(f"kill-{self._mode}-{len(self.faults)}.log")
            log.write_text("\n".join(outcome.faults))

    @property
    def rows(self) -> list[dict[str, object]]:
        """A row for each node and signal."""
        return [
            {
                "mode": self._mode,
                "node": node,
                "signal": number.name,
                "moments": len(outcomes),
                "median [s]": statistics.median(outcome.seconds for outcome in outcomes),
                "max [s]": max(outcome.seconds for outcome in outcomes),
                **self._remarks(outcomes),
                "faults": sum(bool(outcome.faults) for outcome in outcomes),
            }
            for (node, number), outcomes in sorted(self._outcomes.items())
        ]

    @property
    def faults(self) -> list[str]:
        """All faults."""
        return [fault for outcomes in self._outcomes.values() for outcome in outcomes for fault in outcome.faults]

    def _remarks(self, outcomes: Sequence[Outcome]) -> dict[str, object]:
        remarks = [outcome.remark for outcome in outcomes]
        if self._mode == "ends":
            return {f"bag {state}": remarks.count(state) for state in ("finished", "recovered", "none")}
        return {"longest drive [s]": max((float(remark) for remark in remarks if remark), default=0.0)}


def cases(options: argparse.Namespace, nodes: Sequence[str]) -> Iterator[Case]:
    """Yield each node with each signal, as often as wanted, and all of them once before any a second time."""
    for _ in range(options.moments):
        for node in nodes:
            for number in SIGNALS:
                yield node, number


def run_ends(options: argparse.Namespace, port: int, advance: Callable[[], object]) -> Results:
    """Kill required nodes, one per launch."""
    results, generator = Results("ends", options), random.Random(options.seed)
    for node, number in cases(options, [node for node in options.nodes if node not in CONTROLLERS]):
        with tempfile.TemporaryDirectory() as folder:
            results.add((node, number), kill_and_see_the_end(node, number, generator, Path(folder), port))
        advance()
    return results


def run_rejoins(options: argparse.Namespace, port: int, advance: Callable[[], object]) -> Results:
    """Kill nodes that are started again, all in two launches: a process per controller, and one for all of them."""
    results, generator = Results("rejoins", options), random.Random(options.seed)
    for hosted, controllers in (("nodes", CONTROLLERS), ("team", (TEAM,))):
        wanted = [node for node in options.nodes if node in controllers or (node in NODES and hosted == "nodes")]
        left = list(cases(options, wanted))
        while left:  # a launch with a fault is not used further
            left = _kill_in_one_launch(hosted, (*NODES, *controllers), left, results, generator, port, advance)
    return results


def _kill_in_one_launch(
    hosted: str,
    nodes: tuple[str, ...],
    left: list[Case],
    results: Results,
    generator: random.Random,
    port: int,
    advance: Callable[[], object],
) -> list[Case]:
    """Kill nodes until the first fault; return the cases that are left."""
    command = (*ROSLAUNCH, REJOINING, f"controllers:={hosted}", f"scenario:={SCENARIO}")
    with tempfile.TemporaryDirectory() as folder, running(command, Path(folder), port) as program:
        launch = Rejoining(program, nodes, SCENARIO)
        try:
            if not launch.begin():
                results.add(left[0], Outcome((f"{left[0][0]}: the launch did not start\n{program.output}",), 0.0))
                return left[1:]
            for index, case in enumerate(left):
                outcome = launch.kill(*case, generator)
                results.add(case, outcome)
                advance()
                if outcome.faults:
                    return left[index + 1 :]
        finally:
            launch.close()
    return []


MODES = {"ends": run_ends, "rejoins": run_rejoins}


def parsed(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nodes", nargs="*", metavar="NODE", help=f"default all: {' '.join(ALL_NODES)}")
    parser.add_argument("--mode", choices=[*MODES, "both"], default="both", help="(%(default)s)")
    parser.add_argument("--moments", type=int, default=100, metavar="N", help="per node and signal (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    parser.add_argument("--csv", type=Path, default=Path("build/faults/kills.csv"), help="(%(default)s, one per mode)")
    options = parser.parse_args(arguments)
    options.nodes = options.nodes or list(ALL_NODES)
    unknown = [node for node in options.nodes if node not in ALL_NODES]
    if unknown:
        parser.error(f"no node {unknown[0]!r}; expected some of {' '.join(ALL_NODES)}")
    return options


def main(arguments: list[str]) -> int:
    options, console = parsed(arguments), Console()
    sys.setswitchinterval(1e-4)  # receiving threads of rospy must not slow each other down
    faults = []
    for mode in MODES if options.mode == "both" else [options.mode]:
        count = sum(1 for _ in cases(options, [node for node in options.nodes if mode == "ends" or node != RECORDER]))
        with tempfile.TemporaryDirectory() as folder, master(Path(folder)) as port, progress_bar(console) as bar:
            task = bar.add_task(mode, total=count)
            results = MODES[mode](options, port, lambda: bar.advance(task))  # noqa: B023
        shown = [{key: value for key, value in row.items() if key != "mode"} for row in results.rows]
        print_table(console, f"killed nodes: {mode}, seed {options.seed}", shown)
        faults += results.faults
    for fault in faults:
        console.print(fault, markup=False, highlight=False)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
