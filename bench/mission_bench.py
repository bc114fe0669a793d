"""How much faster than real time missions run headless, how long a campaign takes, and how fast a bag is told.

Missions and teams are timed by the processor's time of one core, by turns with sorting a million numbers in NumPy, so
that machines, and hours of one machine, can be compared. A campaign is the command of the dissertation's tables on all
cores: it counts in wall time, from when its workers have started to the last result, as the command tells it.
Usage: python bench/mission_bench.py [--rounds 7] [--trials 30] [--csv FILE]       --trials 0 leaves the campaign out
"""

from __future__ import annotations

import argparse
import csv
import datetime
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robotteamsim.analysis.runs.reading import read_run
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.campaign import read_store
from robotteamsim.recording import BagWriter
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

TEAM_STEPS = 300
CAMPAIGN_GOAL_S = 20.0


@dataclass(frozen=True, slots=True)
class Row:
    """One work. times_real_time: of simulated time.  sortings: how often NumPy sorts while a simulated second runs."""

    work: str
    times_real_time: float
    slowest: float
    fastest: float
    sortings_per_second: float | None = None
    goal: float | None = None

    @property
    def verdict(self) -> str:
        """Whether the goal is met, where there is one."""
        if self.goal is None:
            return ""
        return "met" if self.times_real_time >= self.goal else "MISSED"


def mission() -> float:
    """Run the garage mission; return how long it lasted [s, simulated]."""
    return Simulation(load("garage_sar", ["run.seed=1"])).run().time_s


def team() -> float:
    """Run the first half minute of a hundred robots with RDPSO; return how long that is [s, simulated]."""
    simulation = Simulation(load("garage_sar", ["robots.count=100", "robots.spacing_m=0.45"]))
    simulation.mission.start()
    for _ in range(TEAM_STEPS):
        simulation.step()
    return TEAM_STEPS * simulation.scenario.run.step_s


def bag_of_mission(path: Path) -> Callable[[], float]:
    """Record the garage mission; return a work that reads the bag and says how long it lasted [s, simulated]."""
    Simulation(load("garage_sar", ["run.seed=1"])).run([BagWriter(path)])

    def told() -> float:
        return run_totals(read_run([path])).duration_s

    return told


def busy_s(work: Callable[[], float]) -> tuple[float, float]:
    """Return what a work returns, and the processor's time that it took [s]."""
    start_s = time.process_time()
    result = work()
    return result, time.process_time() - start_s


def measure(name: str, work: Callable[[], float], rounds: int, goal: float | None) -> Row:
    """Return medians over rounds, each of which sorts numbers, too."""
    numbers = np.random.default_rng(1).random(1_000_000)
    work()
    speeds, sortings = [], []
    for _ in range(rounds):
        simulated_s, spent_s = busy_s(work)
        _, sorting_s = busy_s(lambda: float(np.sort(numbers)[0]))
        speeds.append(simulated_s / spent_s)
        sortings.append(spent_s / sorting_s / simulated_s)
    return Row(name, statistics.median(speeds), min(speeds), max(speeds), statistics.median(sortings), goal)


def campaign(trials: int) -> tuple[float, float, float]:
    """Run the dissertation's three levels of noise.

    Returns: wall time after start-up, that of the start-up, simulated time of all missions [s].
    """
    noises = [argument for noise in (10, 20, 30) for argument in ("--noise", str(noise))]
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "robotteamsim.cli", "campaign", "garage_sar", *noises]
        command += ["--trials", str(trials), "--json", "--out", f"{folder}/garage"]
        told = subprocess.run(command, check=True, capture_output=True, text=True).stderr
        simulated_s = sum(outcome.time_s or 0.0 for outcome in read_store(Path(folder, "garage")).outcomes)
    times = re.search(r" in ([0-9.]+) s: .* took ([0-9.]+) s to start", told)
    assert times, told
    return float(times[1]), float(times[2]), simulated_s


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
    """Write rows, each with the date."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("date", "work", "times_real_time", "slowest", "fastest", "goal", "sortings_per_second"))
        for row in rows:
            numbers = row.times_real_time, row.slowest, row.fastest, row.goal, row.sortings_per_second
            texts = ("" if number is None else f"{number:.4g}" for number in numbers)
            writer.writerow((datetime.date.today().isoformat(), row.work, *texts))


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--trials", type=int, default=30, help="of the campaign, at each of three levels of noise")
    parser.add_argument("--csv", type=Path, help="write the table into this file too")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        works = (
            ("garage mission of 3 robots", mission, 1000.0),
            ("30 s of 100 robots with RDPSO", team, 20.0),
            ("bag of a garage mission, told", bag_of_mission(Path(folder, "mission.bag")), None),
        )
        rows = [measure(name, work, options.rounds, goal) for name, work, goal in works]
    if options.trials:
        spent_s, start_up_s, simulated_s = campaign(options.trials)
        count, speed = 3 * options.trials, simulated_s / spent_s
        goal_s = CAMPAIGN_GOAL_S * count / 90.0
        name = f"campaign of {count} garage missions, {spent_s:.1f} s after {start_up_s:.1f} s"
        rows.append(Row(name, speed, speed, speed, goal=simulated_s / goal_s))
    print(table(rows))
    if options.csv:
        write_csv(options.csv, rows)


if __name__ == "__main__":
    main()
