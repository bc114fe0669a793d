"""What the communication term is worth: the office scenario with it and without it, over many seeds.

Both arms run with the same seeds. Printed per figure: the mean of each arm with a 95 % bootstrap interval, and the
p-value of Wilcoxon's signed-rank test of the pairs. A find that the base has not heard of at the end counts as late by
the time that was left. Written: one row per trial, one row per trial and 10 s, and a figure.
Usage: python -m study.network.office_arms [--trials 30] [--workers 2] [--scenario office_manet] [--set K=V] [--again]
       --again takes the trials from the files of the last run and only prints and draws.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import matplotlib as mpl
import numpy as np
from scipy.stats import wilcoxon

from robotteamsim import palette
from robotteamsim.control.cover.floor_cover import FloorCover
from robotteamsim.scenario import load
from robotteamsim.scenario.controllers.cover import CoverControl
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation, StepRecord
from study.intervals import mean_with_interval

RESULTS = Path(__file__).parent
ARMS = {"with": (), "without": ("control.c4=0",)}
FIGURES = {
    "coverage": "floor covered",
    "disconnected": "time not in one piece",
    "base_alone": "robots without a path to the base, mean",
    "lost": "message copies lost on weak links",
    "cut_off": "message copies without a path",
    "found": "victims found",
    "reported": "finds that the base heard of",
    "late_s": "a find reaches the base after, mean [s]",
    "latest_s": "the latest find reaches the base after [s]",
}
EVERY_S = 10.0

Row = dict[str, float | str]


class Watcher:
    """Looks on at one trial and adds up what this study is about."""

    def __init__(self, scenario: Scenario) -> None:
        setup = resolve(scenario)
        reach_m, radius_m = setup.robots[0].reach_m, scenario.control.as_kind(CoverControl).radius_m
        self._cover = FloorCover(setup.building, reach_m, setup.start_m(0), radius_m)
        self._base = scenario.mission.base or 0
        self._step_s = scenario.run.step_s
        self._steps = self._split_steps = self._lost = self._cut_off = 0
        self._apart = 0.0
        self._found_s: dict[str, float] = {}
        self._reported_s: dict[str, float] = {}
        self.series: list[Row] = []

    def step(self, record: StepRecord) -> None:
        """Take in one step."""
        network = record.network
        self._steps += 1
        self._split_steps += network.fiedler_value == 0.0
        self._apart += float(np.count_nonzero(network.hop_count[self._base] < 0))
        self._lost += network.traffic.lost
        self._cut_off += network.traffic.cut_off
        for event in record.events:
            if event.kind == "victim_saved":
                self._found_s[event.subject] = record.sim_time_s
            if event.kind == "discovery_delivered":
                self._reported_s[event.subject] = record.sim_time_s
        if record.step_index % round(1.0 / self._step_s) == 0:
            for reading in record.readings:
                self._cover.look((reading.ground_truth.x_m, reading.ground_truth.y_m))
        if record.step_index % round(EVERY_S / self._step_s) == 0:
            self.series.append(
                {
                    "time_s": record.sim_time_s,
                    "coverage": round(self._cover.share, 4),
                    "disconnected": round(self._split_steps / self._steps, 4),
                    "split_now": int(network.fiedler_value == 0.0),
                }
            )

    def row(self) -> Row:
        """Return the figures of the trial."""
        end_s = self._steps * self._step_s
        late_s = [self._reported_s.get(name, end_s) - found_s for name, found_s in self._found_s.items()]
        return {
            "coverage": round(self._cover.share, 4),
            "disconnected": round(self._split_steps / self._steps, 4),
            "base_alone": round(self._apart / self._steps, 3),
            "lost": self._lost,
            "cut_off": self._cut_off,
            "found": len(self._found_s),
            "reported": len(self._reported_s),
            "late_s": round(float(np.mean(late_s)), 2) if late_s else 0.0,
            "latest_s": round(max(late_s, default=0.0), 2),
        }


def run_trial(name: str, arm: str, seed: int, overrides: Sequence[str]) -> tuple[Row, list[Row]]:
    """Return the figures of one trial, and how it went on."""
    scenario = load(name, [f"run.seed={seed}", *ARMS[arm], *overrides])
    simulation, watcher = Simulation(scenario), Watcher(scenario)
    simulation.mission.start()
    state = "running"
    while state != "ended":
        record = simulation.step()
        watcher.step(record)
        state = record.mission.state
    key: Row = {"arm": arm, "seed": seed}
    return key | watcher.row(), [key | row for row in watcher.series]


def run_all(name: str, trials: int, workers: int, overrides: Sequence[str], files: tuple[Path, Path]) -> None:
    """Run all trials of both arms, and write their figures and how they went on as they come."""
    with ProcessPoolExecutor(workers) as pool:
        futures = [pool.submit(run_trial, name, arm, seed, overrides) for seed in range(1, trials + 1) for arm in ARMS]
        for number, future in enumerate(futures):
            row, course = future.result()
            print(row, flush=True)
            write(files[0], [row], begin=number == 0)
            write(files[1], course, begin=number == 0)


def values(rows: list[Row], arm: str, figure: str) -> np.ndarray:
    """Return a figure of all trials of an arm, by seed."""
    return np.array([float(row[figure]) for row in rows if row["arm"] == arm])


def print_table(rows: list[Row]) -> None:
    """Print both arms side by side."""
    trials = len(values(rows, "with", "seed"))
    print(f"{trials} seeds; mean [95 % bootstrap interval]; Wilcoxon signed-rank test of the pairs")
    print(f"{'':45s} {'with the term':>26s} {'without':>26s} {'p':>9s}")
    for figure, title in FIGURES.items():
        arms = [values(rows, arm, figure) for arm in ARMS]
        p = wilcoxon(*arms).pvalue if np.any(arms[0] != arms[1]) else 1.0
        cells = [f"{mean:.4g} [{low:.4g}, {high:.4g}]" for mean, low, high in map(mean_with_interval, arms)]
        print(f"{title:45s} {cells[0]:>26s} {cells[1]:>26s} {p:9.2g}")


def draw(rows: list[Row], series: list[Row], file: Path) -> None:
    """Draw how coverage and connection went on, and how late the base heard of finds."""
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12.0, 3.8), layout="constrained")
    for arm, colour in (("with", palette.BLUE), ("without", palette.VERMILLION)):
        times_s = sorted({float(row["time_s"]) for row in series})
        label = f"{arm} the term" if arm == "with" else "without it"
        for axis, name in ((axes[0], "coverage"), (axes[1], "split_now")):
            courses = np.array([float(row[name]) for row in series if row["arm"] == arm]).reshape(-1, len(times_s))
            axis.plot(times_s, 100.0 * courses.mean(axis=0), color=colour, label=label)
            if name == "coverage":
                low, high = np.percentile(100.0 * courses, (5, 95), axis=0)
                axis.fill_between(times_s, low, high, color=colour, alpha=0.2, linewidth=0)
        position = list(ARMS).index(arm)
        latest_s = values(rows, arm, "latest_s")
        spread = np.linspace(-0.2, 0.2, len(latest_s))
        axes[2].plot(position + spread, np.sort(latest_s), "o", color=colour, markersize=4, alpha=0.8)
    axes[0].set(title="Floor covered: mean, 5 to 95 %", xlabel="time [s]", ylabel="%", ylim=(0, 100))
    axes[1].set(title="Teams that are not in one piece", xlabel="time [s]", ylabel="% of trials", ylim=(0, 100))
    axes[2].set(title="The base hears of the latest find after", ylabel="s", xticks=(0, 1))
    axes[2].set_xticklabels(["with the term", "without it"])
    axes[0].legend(frameon=False)
    for axis in axes:
        axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(file, dpi=120)


def write(file: Path, rows: list[Row], *, begin: bool) -> None:
    """Write rows as CSV, as a new file or at the end of one."""
    with file.open("w" if begin else "a", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        if begin:
            writer.writeheader()
        writer.writerows(rows)


def read(file: Path) -> list[Row]:
    """Return the rows of a CSV file."""
    with file.open(newline="") as stream:
        return [dict(row) for row in csv.DictReader(stream)]


def main() -> None:
    """Run both arms, print their table, write rows and figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="office_manet")
    parser.add_argument("--trials", type=int, default=30)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--set", action="append", default=[], dest="overrides")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--out", type=Path, default=RESULTS)
    parser.add_argument("--picture", type=Path, default=RESULTS / "office_arms.png")
    options = parser.parse_args()
    trials_file, series_file = options.out / "office_arms.csv", options.out / "office_arms_series.csv"
    if not options.again:
        files = trials_file, series_file
        run_all(options.scenario, options.trials, options.workers, options.overrides, files)
    rows, series = read(trials_file), read(series_file)
    print_table(rows)
    draw(rows, series, options.picture)


if __name__ == "__main__":
    main()
