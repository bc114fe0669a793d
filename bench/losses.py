"""Measures whether a team of RDPSO survives the loss of robots: garage missions from which robots are removed.

The times of the losses are uniform in the first 300 s, and the robots are drawn; both by the seed of the mission.
Printed and written, per row: missions, those that explored all areas, mean time and victims.
Usage: python bench/losses.py [--trials 20] [--csv bench/results/losses.csv] [KEY=VALUE ...]
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np

import robotteamsim as rts
from robotteamsim import rng

CSV = Path(__file__).resolve().parent / "results" / "losses.csv"
FIRST_SEED = 501
LAST_LOSS_S = 300.0


def mission(robots: int, losses: int, seed: int, overrides: list[str]) -> rts.Result:
    """Run a mission of the garage that loses robots."""
    dice = rng.stream(seed, "losses")
    times_s = np.sort(dice.uniform(0.0, LAST_LOSS_S, 2)).round(1).tolist()
    lost = dice.permutation(robots).tolist()
    events = [f"{{at_s: {time_s}, remove: {i}}}" for time_s, i in zip(times_s[:losses], lost, strict=False)]
    keys = [f"robots.count={robots}", f"run.seed={seed}", f"schedule=[{', '.join(events)}]"]
    return rts.Simulation(rts.load("garage_sar", [*keys, *overrides])).run()


def main() -> None:
    """Run all missions, print the table and write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("overrides", nargs="*")
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--csv", type=Path, default=CSV)
    options = parser.parse_args()
    rows = []
    for robots in (3, 5):
        for losses in (0, 1, 2):
            seeds = range(FIRST_SEED, FIRST_SEED + options.trials)
            results = [mission(robots, losses, seed, options.overrides) for seed in seeds]
            complete = sum(result.areas_explored == result.num_areas for result in results)
            time_s = np.mean([result.time_s for result in results])
            victims = np.mean([result.victims_saved for result in results])
            rows.append((robots, losses, len(results), complete, f"{time_s:.0f}", f"{victims:.2f}"))
            print(*rows[-1], flush=True)
    with options.csv.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("robots", "lost", "missions", "complete", "time_s", "victims"))
        writer.writerows(rows)


if __name__ == "__main__":
    main()
