"""Measures the effect of additions to the published RDPSO, in garage missions with all, all but one, one, and none.

All rows run with the same seeds, and with exclusion as printed: missions also end when all robots are excluded. Printed
and written, per row: means with 95 % bootstrap intervals of time, victims and areas, and the share of missions in which
all areas were explored.
Usage: python -m study.swarm.additions [--trials 30] [--noise 20 10] [--workers 2] [--csv FILE]
"""

from __future__ import annotations

import argparse
import csv
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation
from study.intervals import mean_with_interval

CSV = Path(__file__).with_suffix(".csv")
FIRST_SEED = 90001
ADDITIONS = {
    "gated communication": ("control.communication.gated", "true", "false"),
    "ruled-out places": ("control.rule_out_places", "true", "false"),
    "paths around walls": ("control.navigation", "path", "straight"),
    "remembered motion": ("control.memory_of", "motion", "commands"),
}
"""Key of each addition, with its value and that of the equations as printed."""
OTHERS = ("pso", "rpso", "dpso")
PRINTED_EXCLUSION = (
    "control.exclusion.while_approaching=true",
    "control.exclusion.min_robots=0",
    "control.swarms.min=0",
)

Row = dict[str, object]


def rows_of_the_table() -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return scenario and overrides of each row."""
    rows: dict[str, tuple[str, tuple[str, ...]]] = {"all additions": ("garage_sar", PRINTED_EXCLUSION)}
    for name, (key, _, printed) in ADDITIONS.items():
        rows[f"all but {name}"] = ("garage_sar", (*PRINTED_EXCLUSION, f"{key}={printed}"))
    rows["as printed"] = ("garage_sar_published", ())
    for name, (key, ours, _) in ADDITIONS.items():
        rows[f"as printed, with {name}"] = ("garage_sar_published", (f"{key}={ours}",))
    for name in OTHERS:
        rows[f"all additions, {name}"] = ("garage_sar", (f"control.algorithm={name}",))
    return rows


def mission(scenario: str, overrides: tuple[str, ...], noise_db: float, seed: int) -> Result:
    """Return the result of one mission."""
    return Simulation(load(scenario, [*overrides, f"voice.noise_db={noise_db}", f"run.seed={seed}"])).run()


def row_of(name: str, noise_db: float, results: list[Result]) -> Row:
    """Return the summary of a row's missions."""
    row: Row = {"row": name, "noise_db": noise_db, "missions": len(results)}
    values = {
        "time_s": [result.time_s for result in results],
        "victims": [float(result.victims_saved) for result in results],
        "areas": [float(result.areas_explored) for result in results],
        "endangered_links": [float(result.endangered_links) for result in results],
    }
    for key, numbers in values.items():
        mean, low, high = mean_with_interval(np.array(numbers))
        row |= {key: f"{mean:.4g}", f"{key}_low_95": f"{low:.4g}", f"{key}_high_95": f"{high:.4g}"}
    complete = sum(result.areas_explored == result.num_areas for result in results)
    return row | {"complete": f"{complete / len(results):.3g}"}


def write_rows(path: Path, rows: list[Row]) -> None:
    """Write the rows as a table with a header."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    """Run all missions, print the table and write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=30)
    parser.add_argument("--noise", type=float, nargs="+", default=[20.0, 10.0], metavar="DB")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--csv", type=Path, default=CSV)
    options = parser.parse_args()
    seeds = range(FIRST_SEED, FIRST_SEED + options.trials)
    rows: list[Row] = []
    with ProcessPoolExecutor(options.workers) as pool:
        futures = {
            (name, noise_db): [pool.submit(mission, scenario, overrides, noise_db, seed) for seed in seeds]
            for noise_db in options.noise
            for name, (scenario, overrides) in rows_of_the_table().items()
        }
        for (name, noise_db), trials in futures.items():
            row = row_of(name, noise_db, [trial.result() for trial in trials])
            rows.append(row)
            cells = [f"{row[key]} [{row[f'{key}_low_95']}, {row[f'{key}_high_95']}]" for key in ("time_s", "victims")]
            line = f"{noise_db:3g} dB  {name:42}{cells[0]:>24}{cells[1]:>22}{row['areas']:>8}{row['complete']:>8}"
            print(line, flush=True)
    write_rows(options.csv, rows)


if __name__ == "__main__":
    main()
