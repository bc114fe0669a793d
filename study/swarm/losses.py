"""Measures whether teams of RDPSO survive the loss of robots: missions from which robots are removed at random times.

The times of the losses are uniform in the first 300 s, and the robots are drawn, both by the seed of the mission. The
garage is that of garage_sar; in the office, robots explore four areas and hear victims at 30 dB. Missions may last
1200 s: at 600 s, the limit of garage_sar, some teams are still on their way. Each mission is written as soon as it has
ended; with --again, all run again, otherwise only those that the file lacks. Printed, per cell: missions, those that
explored all areas, those that did so within 600 s, different trajectories, and means of time and victims.
Usage: python -m study.swarm.losses [--trials 20] [--again] [--csv FILE] [KEY=VALUE ...]
"""

from __future__ import annotations

import argparse
import csv
import itertools
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import robotteamsim as rts
from robotteamsim import rng
from study.swarm.adaptation import OFFICE
from study.swarm.additions import PRINTED_EXCLUSION

CSV = Path(__file__).with_suffix(".csv")
FIRST_SEED = 601
LAST_LOSS_S = 300.0
SHORT_S = 600.0
LIMIT_S = 1200.0
PRINTED = "office, exclusion as printed"
BUILDINGS = {
    "garage": ("garage_sar", ()),
    "office": ("office_manet", OFFICE),
    PRINTED: ("office_manet", (*OFFICE, *PRINTED_EXCLUSION)),
}
"""Scenario and overrides."""
LOSSES = (0, 1, 2)
CELLS = (*itertools.product(("garage", "office"), (3, 5), LOSSES), *itertools.product((PRINTED,), (3,), LOSSES))
"""Building, number of robots, and of losses."""
KEYS = ("building", "robots", "lost", "seed", "end", "areas", "all_areas", "time_s", "victims", "hash")

Row = dict[str, str]


def mission(building: str, robots: int, losses: int, seed: int, overrides: list[str]) -> Row:
    """Return the result of a mission that loses robots."""
    scenario, keys = BUILDINGS[building]
    dice = rng.stream(seed, "losses")
    times_s = np.sort(dice.uniform(0.0, LAST_LOSS_S, 2)).round(1).tolist()
    lost = dice.permutation(robots).tolist()
    events = [f"{{at_s: {time_s}, remove: {i}}}" for time_s, i in zip(times_s[:losses], lost, strict=False)]
    own = [
        f"robots.count={robots}",
        f"run.seed={seed}",
        f"mission.time_limit_s={LIMIT_S}",
        f"schedule=[{', '.join(events)}]",
    ]
    result = rts.Simulation(rts.load(scenario, [*keys, *own, *overrides])).run()
    all_areas = int(result.areas_explored == result.num_areas)
    values = (building, robots, losses, seed, result.end, result.areas_explored, all_areas)
    more = (f"{result.time_s:.1f}", result.victims_saved, result.trajectory_hash[:12])
    return dict(zip(KEYS, map(str, (*values, *more)), strict=True))


def table(rows: list[Row]) -> Iterator[str]:
    """Yield a line per cell."""
    yield f"{'building':30}robots  lost     all areas  in 600 s  different  time_s  victims"
    for cell in CELLS:
        own = [row for row in rows if (row["building"], int(row["robots"]), int(row["lost"])) == cell]
        if own:
            complete = [row for row in own if row["all_areas"] == "1"]
            short = sum(float(row["time_s"]) <= SHORT_S for row in complete)
            time_s, victims = (np.mean([float(row[key]) for row in own]) for key in ("time_s", "victims"))
            different = len({row["hash"] for row in own})
            counts = f"{len(complete):>7} of {len(own):>3}{short:>10}{different:>11}"
            yield f"{cell[0]:29}{cell[1]:>7}{cell[2]:>6}{counts}{time_s:>8.0f}{victims:>9.2f}"


def main() -> None:
    """Run the missions that the file lacks, write each, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("overrides", nargs="*")
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--csv", type=Path, default=CSV)
    options = parser.parse_args()
    rows: list[Row] = []
    if options.csv.exists() and not options.again:
        with options.csv.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    done = {(row["building"], int(row["robots"]), int(row["lost"]), int(row["seed"])) for row in rows}
    with options.csv.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, KEYS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        for cell, seed in itertools.product(CELLS, range(FIRST_SEED, FIRST_SEED + options.trials)):
            if (*cell, seed) not in done:
                rows.append(mission(*cell, seed, options.overrides))
                writer.writerow(rows[-1])
                file.flush()
    print(*table(rows), sep="\n")


if __name__ == "__main__":
    main()
