"""How many robot steps environments for learning make per second on one core, observations included.

A robot step is 0.1 s of one robot. Speeds are per second of processor time of a process with one thread, which a busy
machine slows less than wall time. Our environments and their peers (learning_cases.py) alternate; the table has medians
over rounds, and ratios to `parallel_env` in the same round. Then some of ours run once for longer: their resident
memory, and its growth per hour of processor time. Run by `make bench_learning`.
Usage: python bench/learning_bench.py PYTHON_OF_PEERS [--rounds 5] [--seconds 3] [--soak 300] [--csv FILE]
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import results_file
from learning_cases import CASES, SOAKED, Case

from robotteamsim.scenario import load
from robotteamsim.scenario.plan import solids
from robotteamsim.setup import resolve

SPEEDS = ("robot_steps_per_s", "slowest", "fastest", "per_wall_s", "ratio", "goal")
COLUMNS = ("environment", "missions", "robots", *SPEEDS, "robot_steps", "memory_mb", "mb_per_hour", "computes")
Row = dict[str, Any]


def building() -> dict[str, Any]:
    """Return the garage and its robots, for simulators that do not read our scenarios."""
    setup = resolve(load("garage_sar"))
    robot = setup.robots[0]
    return {
        "size_m": setup.plan.bounds.max,
        "walls": [solid.corners for solid in solids(setup.plan)],
        "starts": [other.start_pose for other in setup.robots],
        "radius_m": robot.radius_m,
        "speed_mps": robot.drive.max_speed_mps,
        "turn_radps": robot.drive.max_turn_radps,
        "laser_m": robot.laser.forward_m,
    }


def run(name: str, case: Case, seconds: float, path: Path, peers: Path) -> dict[str, float]:
    """Measure a case once, in a process of its own."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    if case.is_peer:
        environment.pop("PYTHONPATH", None)  # it has our packages
    script = Path(__file__).with_name("learning_cases.py")
    command = (peers if case.is_peer else sys.executable, script, name, path, str(seconds))
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=environment)
    measured: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return measured


def compared(rounds: list[dict[str, dict[str, float]]]) -> list[Row]:
    """Return the rows of cases that were measured in each round: medians, and ratios to the first case."""
    rows, first = [], next(iter(CASES))
    for name, case in CASES.items():
        speeds = [each[name]["robot_steps_per_s"] for each in rounds]
        ratios = [each[name]["robot_steps_per_s"] / each[first]["robot_steps_per_s"] for each in rounds]
        medians = {key: statistics.median(each[name][key] for each in rounds) for key in ("per_wall_s", "memory_mb")}
        medians |= {"robot_steps_per_s": statistics.median(speeds), "ratio": statistics.median(ratios)}
        rows.append(described(name, case) | medians | {"slowest": min(speeds), "fastest": max(speeds)})
    return rows


def described(name: str, case: Case) -> Row:
    """Return what is known of a row before it is measured."""
    known = ("missions", "robots", "goal", "computes")
    return {"environment": name} | {key: getattr(case, key) for key in known}


def texts(row: Row) -> list[str]:
    """Return a row as texts, in the order of the columns."""
    values = ("" if row.get(key) is None else row[key] for key in COLUMNS)
    return [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]


def table(rows: list[Row]) -> str:
    """Return rows as text."""
    lines = [list(COLUMNS), *map(texts, rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)) for line in lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("peers", type=Path, help="the Python that has VMAS and IR-SIM")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=3.0, help="processor time of each case in a round")
    parser.add_argument("--soak", type=float, default=300.0, help="processor time of each case that runs for long")
    parser.add_argument("--csv", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "garage.json")
        path.write_text(json.dumps(building()), encoding="utf-8")
        rounds = [
            {name: run(name, case, options.seconds, path, options.peers) for name, case in CASES.items()}
            for _ in range(options.rounds)
        ]
        rows = compared(rounds)
        for name, case in SOAKED.items():
            rows.append(described(name, case) | run(name, case, options.soak, path, options.peers))
    print(table(rows))
    if options.csv:
        results_file.append_rows(options.csv, COLUMNS, list(map(texts, rows)))


if __name__ == "__main__":
    main()
