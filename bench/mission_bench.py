"""The speed of headless missions, of campaigns and of reading a bag, relative to real time.

Missions and teams are measured in processor time of one core, in alternation with sorting a million numbers in NumPy,
so that machines, and hours of one machine, can be compared. The campaign is the command of the dissertation's tables on
all cores. It is measured in wall time, with the start of its workers, as the command reports it.
Usage: python bench/mission_bench.py [--rounds 7] [--trials 30] [--csv FILE]       --trials 0 omits the campaign
"""

from __future__ import annotations

import argparse
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from results_file import append_rows

from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.campaign import read_store
from robotteamsim.recording import BagWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

TEAM_GOALS = {30: 100.0, 100: 30.0, 300: 6.0, 1000: 1.0}
"""Times real time, by the number of robots."""

TEAM_S = 5.0
MISSION_GOAL = 1300.0
CAMPAIGN_GOAL_S = 18.0


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement. sortings_per_second: how often NumPy sorts in the time that a simulated second takes."""

    work: str
    times_real_time: float
    slowest: float
    fastest: float
    sortings_per_second: float | None = None
    goal: float | None = None

    @property
    def verdict(self) -> str:
        """Whether the goal is met; empty without a goal."""
        if self.goal is None:
            return ""
        return "met" if self.times_real_time >= self.goal else "MISSED"


Work = Callable[[], float]
"""What is timed; returns how long it lasted in simulated time [s]."""


def mission() -> Work:
    """Return a run of the garage mission."""
    scenario = load("garage_sar", ["run.seed=1"])
    return lambda: Simulation(scenario).run().time_s


def team(robots: int) -> Work:
    """Return the first 5 s of a team with RDPSO, without its set-up."""
    simulation = Simulation(load("garage_sar", [f"robots.count={robots}", "robots.spacing_m=0.45"]))
    simulation.mission.start()

    def run() -> float:
        for _ in range(round(TEAM_S / simulation.scenario.run.step_s)):
            simulation.step()
        return TEAM_S

    return run


def reading_bag(path: Path) -> Work:
    """Return the reading of a bag, which is recorded first if there is none."""
    if not path.exists():
        Simulation(load("garage_sar", ["run.seed=1"])).run([BagWriter(path)])
    return lambda: run_totals(read_run([path], layers=False)).duration_s


def busy_s(work: Work) -> tuple[float, float]:
    """Return the result of a function and its processor time [s]."""
    start_s = time.process_time()
    result = work()
    return result, time.process_time() - start_s


def measure(name: str, prepare: Callable[[], Work], rounds: int, goal: float | None) -> Row:
    """Return medians over rounds; each round also sorts numbers. Preparation is not timed."""
    numbers = np.random.default_rng(1).random(1_000_000)
    prepare()()
    speeds, sortings = [], []
    for _ in range(rounds):
        simulated_s, spent_s = busy_s(prepare())
        _, sorting_s = busy_s(lambda: float(np.sort(numbers)[0]))
        speeds.append(simulated_s / spent_s)
        sortings.append(spent_s / sorting_s / simulated_s)
    return Row(name, statistics.median(speeds), min(speeds), max(speeds), statistics.median(sortings), goal)


def campaign(trials: int) -> tuple[float, float]:
    """Run the dissertation's three levels of noise; return wall time and simulated time of all missions [s]."""
    noises = [argument for noise in (10, 20, 30) for argument in ("--noise", str(noise))]
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "robotteamsim.cli", "campaign", "garage_sar", *noises]
        command += ["--trials", str(trials), "--json", "--out", f"{folder}/garage"]
        shown = subprocess.run(command, check=True, capture_output=True, text=True).stderr
        simulated_s = sum(outcome.time_s or 0.0 for outcome in read_store(Path(folder, "garage")).outcomes)
    spent_s = re.search(r" in ([0-9.]+) s: ", shown)
    assert spent_s, shown
    return float(spent_s[1]), simulated_s


def table(rows: list[Row]) -> str:
    """Return rows as text."""
    lines = [("work", "times real time", "rounds", "goal", "", "sortings a simulated second")]
    for row in rows:
        spread = f"{row.slowest:,.0f} to {row.fastest:,.0f}"
        goal = "" if row.goal is None else f"{row.goal:,.0f}"
        sortings = "" if row.sortings_per_second is None else f"{row.sortings_per_second:.3g}"
        lines.append((row.work, f"{row.times_real_time:,.1f}", spread, goal, row.verdict, sortings))
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)) for line in lines)


def write_csv(path: Path, rows: list[Row]) -> None:
    """Append the rows to a file."""
    table = []
    for row in rows:
        numbers = row.times_real_time, row.slowest, row.fastest, row.goal, row.sortings_per_second
        table.append((row.work, *("" if number is None else f"{number:.4g}" for number in numbers)))
    append_rows(path, ("work", "times_real_time", "slowest", "fastest", "goal", "sortings_per_second"), table)


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--trials", type=int, default=30, help="trials of the campaign at each of three noise levels")
    parser.add_argument("--csv", type=Path, help="append the table to this file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        works = (
            ("garage mission of 3 robots", mission, MISSION_GOAL),
            *(
                (f"first 5 s of {robots} robots with RDPSO", partial(team, robots), goal)
                for robots, goal in TEAM_GOALS.items()
            ),
            ("reading the bag of a garage mission", partial(reading_bag, Path(folder, "mission.bag")), None),
        )
        rows = [measure(name, prepare, options.rounds, goal) for name, prepare, goal in works]
    if options.trials:
        spent_s, simulated_s = campaign(options.trials)
        count, speed = 3 * options.trials, simulated_s / spent_s
        goal_s = CAMPAIGN_GOAL_S * count / 90.0
        name = f"campaign of {count} garage missions, {spent_s:.1f} s"
        rows.append(Row(name, speed, speed, speed, goal=simulated_s / goal_s))
    print(table(rows))
    if options.csv:
        write_csv(options.csv, rows)


if __name__ == "__main__":
    main()
